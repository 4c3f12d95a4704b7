#pragma once

#include "geometry/math.h"

#include <span>

namespace lorica {

/// All points within a radius of a segment; a ball if both ends are equal.
struct Capsule {
  Vec3 from = Vec3::Zero();  ///< one end of the segment [m]
  Vec3 to = Vec3::Zero();    ///< the other end [m]
  double radius = 0.0;       ///< [m]

  [[nodiscard]] double volume() const;  ///< [m^3]
  /// Distance of a point outside it [m]; at most 0 inside.
  [[nodiscard]] double outside(const Vec3& p) const;
};

/// A small capsule that holds all points: about one of their principal axes, whichever gives the least volume. Not the
/// smallest of all capsules. @param points  at least one
[[nodiscard]] Capsule capsuleAround(std::span<const Vec3> points);

/// A capsule with the same middle and proportions and another volume. @param volume  [m^3], at least 0
[[nodiscard]] Capsule withVolume(const Capsule& capsule, double volume);

}  // namespace lorica
