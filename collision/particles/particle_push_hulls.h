#pragma once

#include "collision/live/live_part.h"
#include "geometry/math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// The planes of the live parts, prepared for queries in single precision. Everything here is internal to ParticlePush.
///
/// Local coordinates are world coordinates minus `origin`, the lower corner of the box of all hulls. They are small, so
/// that float is accurate to some tenths of a micron, and above 0 inside the hulls.
class PushHulls {
 public:
  /// Planes are stored in whole blocks; surplus entries are infinitely far away, so that no point is above them.
  static constexpr std::size_t kBlock = 16;

  struct Hull {
    std::uint32_t part = 0;
    /// First the planes of faces that may lead out, then those of faces with another hull in front; each kind in whole
    /// blocks.
    std::size_t firstPlane = 0;
    std::size_t exitCount = 0;   ///< of the first kind
    std::size_t planeCount = 0;  ///< of both
    Vec3f boxMin, boxMax;        ///< local, enlarged by the radius
    /// Velocity at a position [m/s]: velocityOfPosition * position + velocity.
    Eigen::Matrix3f velocityOfPosition;
    Vec3f velocity;
  };

  /// @param radius  the planes are moved outward by it [m]
  /// @param again   see ParticlePush::prepare()
  void prepare(std::span<const LivePart> parts, double seconds, double radius, bool again);

  [[nodiscard]] std::span<const Hull> hulls() const { return hulls_; }
  [[nodiscard]] const Vec3f& origin() const { return origin_; }
  [[nodiscard]] const Vec3f& boxMax() const { return boxMax_; }  ///< local, of all hulls; the lower corner is 0
  /// Particles are placed this far above a plane, so that rounding cannot leave them below [m].
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
  /// A face as read from the part.
  struct Face {
    Vec3f normal;
    float offset = 0.0F;  ///< without the radius
    Triangle corners;     ///< indices into vertices_
    bool covered = false;
  };
  /// A hull as read from the part: ranges of vertices_ and faces_.
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
