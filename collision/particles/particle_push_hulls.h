#pragma once

#include "collision/live/live_part.h"
#include "geometry/math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// The planes of the live parts, ready to be asked in single precision. Internal to ParticlePush, as all here.
///
/// Local coordinates are world ones less `origin`, the lower corner of the box of all: small, so that float is fine to
/// some tenths of a micron, and above 0 wherever a hull is.
class PushHulls {
 public:
  /// Planes lie in whole blocks; what a block has too much is infinitely far away, so that no point is above it.
  static constexpr std::size_t kBlock = 16;

  struct Hull {
    std::uint32_t part = 0;
    /// First those of faces that may lead out, then those of faces with another hull before them; each kind in whole
    /// blocks.
    std::size_t firstPlane = 0;
    std::size_t exitCount = 0;   ///< of the first kind
    std::size_t planeCount = 0;  ///< of both
    Vec3f boxMin, boxMax;        ///< local, grown by the radius
    /// A place's velocity [m/s]: velocityOfPlace * place + velocity.
    Eigen::Matrix3f velocityOfPlace;
    Vec3f velocity;
  };

  /// @param radius  the planes are moved outward by it [m]
  /// @param again   see ParticlePush::prepare()
  void prepare(std::span<const LivePart> parts, double seconds, double radius, bool again);

  [[nodiscard]] std::span<const Hull> hulls() const { return hulls_; }
  [[nodiscard]] const Vec3f& origin() const { return origin_; }
  [[nodiscard]] const Vec3f& boxMax() const { return boxMax_; }  ///< local, of all hulls; the lower corner is 0
  /// Particles are put this far above a plane, so that no rounding leaves them below [m].
  [[nodiscard]] float margin() const { return margin_; }
  [[nodiscard]] Vec3f normal(std::size_t plane) const { return {x_[plane], y_[plane], z_[plane]}; }
  /// How far a point is above a plane [m].
  [[nodiscard]] float height(std::size_t plane, const Vec3f& p) const {
    return ((x_[plane] * p.x() + y_[plane] * p.y()) + z_[plane] * p.z()) - offset_[plane];
  }
  /// Coordinates of all planes' normals, and offsets.
  [[nodiscard]] const float* x() const { return x_.data(); }
  [[nodiscard]] const float* y() const { return y_.data(); }
  [[nodiscard]] const float* z() const { return z_.data(); }
  [[nodiscard]] const float* offset() const { return offset_.data(); }
  [[nodiscard]] Vec3f surfaceVelocity(const Hull& hull, const Vec3f& p) const;

 private:
  /// A face as it comes.
  struct Face {
    Vec3f normal;
    float offset = 0.0F;  ///< without the radius
    Triangle corners;     ///< among vertices_
    bool covered = false;
  };
  /// A hull as it comes: ranges of vertices_ and faces_.
  struct Raw {
    const LivePart* part = nullptr;
    std::uint32_t index = 0;
    std::size_t firstVertex = 0, endVertex = 0, firstFace = 0, endFace = 0;
    Vec3f boxMin, boxMax;
  };

  void takeHull(const LivePart& part, std::uint32_t index);
  void findCovered();
  void addHull(const Raw& raw, double seconds, double radius);
  void addPlanes(const Raw& raw, bool covered, float radius);

  Vec3f origin_ = Vec3f::Zero();
  Vec3f boxMax_ = Vec3f::Zero();
  float margin_ = 0.0F;
  std::vector<Hull> hulls_;
  std::vector<float> x_, y_, z_, offset_;
  // Scratch.
  std::vector<Vec3f> vertices_;
  std::vector<Face> faces_;
  std::vector<Raw> raw_;
  std::vector<bool> coveredVertices_, wereCovered_;
};

}  // namespace lorica
