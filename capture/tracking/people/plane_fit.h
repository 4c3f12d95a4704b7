#pragma once

#include "capture/tracking/people/depth_grid.h"
#include "geometry/math.h"
#include "geometry/random_numbers.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace lorica {

// What finding the floor and finding walls have in common: samples of the image, planes through three random ones
// (RANSAC), and weighted least squares.

inline constexpr int kPlaneTries = 96;  ///< planes tried in a search

/// Max number of samples of an image.
[[nodiscard]] std::size_t planeSampleCount(const DepthGrid& grid);

/// Positions of the cells around a sample that define its normal; camera frame [m].
struct PlaneArms {
  Vec3f left, right, above, below;
  [[nodiscard]] bool seen() const;
  /// Towards the camera, of any length.
  [[nodiscard]] Vec3f normal() const { return (right - left).cross(above - below); }
};

/// Calls visit(depthMm, position, arms) for each sample with a depth, row by row.
template <class Visit>
void visitPlaneSamples(const DepthGrid& grid, const Visit& visit) {
  constexpr int kSpacing = 4;  // cells between samples
  constexpr int kArm = 4;      // cells from a sample to the cells that define its normal
  for (int r = kArm; r + kArm < grid.height; r += kSpacing) {
    for (int c = kArm; c + kArm < grid.width; c += kSpacing) {
      const std::uint16_t depthMm = grid.depthMm[grid.index(c, r)];
      if (depthMm == 0) continue;
      visit(depthMm, grid.positionOf(c, r),
            PlaneArms{grid.positionOf(c - kArm, r), grid.positionOf(c + kArm, r), grid.positionOf(c, r - kArm),
                      grid.positionOf(c, r + kArm)});
    }
  }
}

/// Tries planes through three random samples.
/// @param positionOf    the position of sample 0 to count - 1
/// @param planeThrough  the plane through three positions; nothing if it is not acceptable
/// @param score         of a plane
/// @param plane         out: the best plane
/// @return its score; 0 if no plane has more
template <class Plane, class PositionOf, class PlaneThrough, class Score>
double bestPlane(std::uint64_t seed, std::size_t count, const PositionOf& positionOf, const PlaneThrough& planeThrough,
                 const Score& score, Plane& plane) {
  RandomNumbers random(seed);
  double best = 0.0;
  for (int i = 0; i < kPlaneTries; ++i) {
    std::array<Vec3f, 3> corners;
    for (Vec3f& corner : corners) {
      corner = positionOf(static_cast<std::size_t>(random.unit() * count));
    }
    const std::optional<Plane> tried = planeThrough(corners);
    if (!tried) continue;
    const double value = score(*tried);
    if (value <= best) continue;
    best = value;
    plane = *tried;
  }
  return best;
}

/// Weighted least squares: the plane from which positions are least far.
class PlaneMoments {
 public:
  void add(const Vec3& position, double weight);
  [[nodiscard]] int count() const { return count_; }

  struct Fit {
    Vec3 middle;          ///< of the positions [m]
    Vec3 normal;          ///< unit, of either sign
    double extent = 0.0;  ///< standard deviation along the shorter side [m]
  };
  /// Of one position or more.
  [[nodiscard]] Fit fit() const;

 private:
  int count_ = 0;
  double weights_ = 0.0;
  Vec3 sum_ = Vec3::Zero();
  Mat3 products_ = Mat3::Zero();
};

}  // namespace lorica
