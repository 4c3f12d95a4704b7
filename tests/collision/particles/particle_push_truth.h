#pragma once

#include "collision/live/live_part.h"
#include "geometry/math.h"

#include <span>
#include <vector>

namespace lorica::test {

/// Slow reference for the hulls of live parts: all planes of all hulls, in double precision.
class ParticleTruth {
 public:
  explicit ParticleTruth(std::span<const LivePart> parts);

  /// How far a point is above the highest plane of a part's hull [m]: below 0 inside. A part without faces is
  /// infinitely distant.
  [[nodiscard]] double height(std::size_t part, const Vec3& p) const;
  /// The min height over all parts.
  [[nodiscard]] double lowest(const Vec3& p) const;
  /// Whether a face of a part's hull has this normal and a plane within this distance of the point [m].
  [[nodiscard]] bool hasFace(std::size_t part, const Vec3& p, const Vec3& normal, double distance) const;
  /// Approximate upper bound of the shortest distance out of all hulls, tried along many directions; 0 outside.
  [[nodiscard]] double wayOut(const Vec3& p) const;

 private:
  struct Plane {
    Vec3 normal;
    double offset = 0.0;
  };
  std::vector<std::vector<Plane>> planes_;  ///< for each part
  std::vector<Vec3> directions_;
};

}  // namespace lorica::test
