#pragma once

#include "collision/live_part.h"
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
    std::size_t firstPlane = 0;
    std::size_t planeCount = 0;  ///< in whole blocks
    Vec3f boxMin, boxMax;        ///< local, grown by the radius
    /// A place's velocity [m/s]: velocityOfPlace * place + velocity.
    Eigen::Matrix3f velocityOfPlace;
    Vec3f velocity;
  };

  /// One plane of a hull, and how far a point is above it.
  struct Nearest {
    float height = 0.0F;
    std::size_t plane = 0;
  };

  /// @param radius  the planes are moved outward by it [m]
  void prepare(std::span<const LivePart> parts, double seconds, double radius);

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
  /// The plane of a hull that a point is highest above, the first of several: below 0, the point is inside and that is
  /// the nearest way out.
  [[nodiscard]] Nearest nearest(const Hull& hull, const Vec3f& p) const;
  [[nodiscard]] Vec3f surfaceVelocity(const Hull& hull, const Vec3f& p) const;

 private:
  void addHull(const LivePart& part, std::uint32_t index, double seconds, double radius);

  Vec3f origin_ = Vec3f::Zero();
  Vec3f boxMax_ = Vec3f::Zero();
  float margin_ = 0.0F;
  std::vector<Hull> hulls_;
  std::vector<float> x_, y_, z_, offset_;
  std::vector<Vec3> vertices_;  ///< scratch: of one hull, local
};

}  // namespace lorica
