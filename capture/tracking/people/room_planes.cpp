#include "capture/tracking/people/room_planes.h"

#include "geometry/random_numbers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace lorica {
namespace {

// What finding the floor and finding walls have in common: samples of the image, planes through three random ones
// (RANSAC), and weighted least squares.

constexpr int kPlaneTries = 96;  ///< planes tried in a search

/// Max number of samples of an image.
std::size_t planeSampleCount(const DepthGrid& grid) {
  return grid.cellCount() / 16 + 1;
}

/// Positions of the cells around a sample that define its normal; camera frame [m].
struct PlaneArms {
  Vec3f left, right, above, below;
  [[nodiscard]] bool seen() const {
    return left.z() != 0.0F && right.z() != 0.0F && above.z() != 0.0F && below.z() != 0.0F;
  }
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
    for (Vec3f& corner : corners) corner = positionOf(static_cast<std::size_t>(random.unit() * count));
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
  void add(const Vec3& position, double weight) {
    ++count_;
    weights_ += weight;
    sum_ += weight * position;
    products_ += weight * position * position.transpose();
  }
  [[nodiscard]] int count() const { return count_; }

  struct Fit {
    Vec3 middle;          ///< of the positions [m]
    Vec3 normal;          ///< unit, of either sign
    double extent = 0.0;  ///< standard deviation along the shorter side [m]
  };
  /// Of one position or more.
  [[nodiscard]] Fit fit() const {
    const Vec3 middle = sum_ / weights_;
    const SymmetricAxes axes = symmetricAxes(Mat3(products_ / weights_ - middle * middle.transpose()));
    return {middle, axes.vectors.col(0), std::sqrt(std::max(0.0, axes.values[1]))};
  }

 private:
  int count_ = 0;
  double weights_ = 0.0;
  Vec3 sum_ = Vec3::Zero();
  Mat3 products_ = Mat3::Zero();
};

// Of floors.
constexpr int kSearch = 15, kSearchFast = 5;  // frames between searches for another one; while the camera moves
constexpr int kDoubts = 3;                    // searches that another one must win
constexpr double kMinLevel = 60;              // min samples on a floor
constexpr double kMaxTilt = 40.0 * EIGEN_PI / 180.0;
constexpr double kMaxRoll = 20.0 * EIGEN_PI / 180.0;

// Of walls.
constexpr int kPause = 15;          // frames between searches
constexpr std::size_t kWalls = 3;   // at most
constexpr double kMinShare = 0.05;  // of the samples
constexpr double kMinCount = 120;
constexpr double kMinExtent = 0.25;      // standard deviation along the shorter side [m]; less may be a person's trunk
constexpr float kMaxSlope = 0.5F;        // sine of the angle between a wall and the vertical
constexpr float kAligned = 0.85F;        // least cosine of the angle between a sample's and the wall's normal
constexpr float kBehindWall = 0.10F;     // farther than this behind a wall lies what refutes it [m]
constexpr double kBehindPenalty = 8.0;   // samples on the plane that outweigh one behind it
constexpr double kBehindAllowed = 0.02;  // of the samples: through doors, windows and mirrors

}  // namespace

FloorFinder::FloorFinder(const DepthGrid& grid) {
  samples_.reserve(planeSampleCount(grid));
  level_.reserve(planeSampleCount(grid));
}

void FloorFinder::takeSamples(const DepthGrid& grid) {
  samples_.clear();
  level_.clear();
  visitPlaneSamples(grid, [&](std::uint16_t, const Vec3f& position, const PlaneArms& arms) {
    const float depth = -position.z();
    // The height error is the depth error times the slope of the ray, which is the camera's height over the depth.
    Sample sample{position, 2.5F * depthNoise(depth) / depth, false};
    if (arms.seen()) {
      const Vec3f normal = arms.normal();
      const bool smooth = std::abs(arms.right.z() - arms.left.z()) < 0.15F * depth &&
                          std::abs(arms.above.z() - arms.below.z()) < 0.3F * depth;
      sample.level = smooth && normal.y() > 0.7F * normal.norm();
    }
    if (sample.level) level_.push_back(samples_.size());
    samples_.push_back(sample);
  });
}

bool FloorFinder::sensible(const Plane& plane) const {
  return plane.height >= 0.3 && plane.height <= 2.5 && plane.up.y() >= std::cos(kMaxTilt) &&
         std::abs(plane.up.x()) <= std::sin(kMaxRoll);
}

double FloorFinder::score(const Plane& plane) const {
  const Vec3f up = plane.up.cast<float>();
  const float height = plane.height;
  int on = 0, under = 0;
  for (const Sample& s : samples_) {
    const float above = up.dot(s.position) + height;
    const float tolerance = 0.015F + s.tolerance * height;
    on += s.level && std::abs(above) < tolerance;
    under += above < -0.06F - 2.0F * tolerance;
  }
  // Mirrors and windows show a few points below any floor.
  return on - 40.0 * std::max(0.0, under - 0.003 * samples_.size());
}

bool FloorFinder::refine(Plane& plane) const {
  const double height = plane.height;
  PlaneMoments moments;
  for (const std::uint32_t i : level_) {
    const Sample& s = samples_[i];
    const Vec3 position = s.position.cast<double>();
    const double tolerance = 0.015 + s.tolerance * height;
    if (std::abs(plane.up.dot(position) + height) < tolerance) moments.add(position, 1.0 / (tolerance * tolerance));
  }
  if (moments.count() < kMinLevel) return false;
  const PlaneMoments::Fit fit = moments.fit();
  if (fit.extent < 0.1) return false;  // the top of an object
  const Vec3 up = fit.normal.y() < 0.0 ? Vec3(-fit.normal) : fit.normal;
  plane = {up, -up.dot(fit.middle)};
  return sensible(plane);
}

bool FloorFinder::detect(Plane& plane) {
  if (level_.size() < kMinLevel) return false;
  const auto positionOf = [&](std::size_t i) { return samples_[level_[i]].position; };
  const auto planeThrough = [&](const std::array<Vec3f, 3>& corners) -> std::optional<Plane> {
    const Vec3 first = corners[0].cast<double>();
    const Vec3 normal = (corners[1].cast<double>() - first).cross(corners[2].cast<double>() - first);
    if (normal.norm() < 0.01) return std::nullopt;
    Plane tried{normal.normalized(), 0.0};
    if (tried.up.y() < 0.0) tried.up = -tried.up;
    tried.height = -tried.up.dot(first);
    if (!sensible(tried)) return std::nullopt;
    return tried;
  };
  const double best = bestPlane(
      static_cast<std::uint64_t>(frameCount_) + 1, level_.size(), positionOf, planeThrough,
      [&](const Plane& tried) { return score(tried); }, plane);
  if (best < 0.5 * kMinLevel) return false;
  for (int i = 0; i < 3; ++i) {
    if (!refine(plane)) return false;
  }
  return score(plane) >= kMinLevel;
}

void FloorFinder::update(const DepthGrid& grid, bool moves) {
  takeSamples(grid);
  const int frame = frameCount_++;
  if (!found_) {
    // A floor may come into view at any time; searching for it costs more than everything else.
    if (frame >= 10 && frame % 10 != 0) return;
    found_ = detect(plane_);
    followed_ = 1;
    return;
  }
  if (moves) followed_ = 1;
  Plane now = plane_;
  if (refine(now)) {
    const double share = std::max(1.0 / (1.0 + followed_), 0.02);
    plane_.up = (plane_.up + share * (now.up - plane_.up)).normalized();
    plane_.height += share * (now.height - plane_.height);
    ++followed_;
  }
  if (frame % (moves ? kSearchFast : kSearch) != 0) return;
  // The camera was moved, or the plane taken for the floor turns out to have something below it.
  Plane other;
  const bool better = detect(other) && score(other) > 1.5 * std::max(0.0, score(plane_)) + kMinLevel;
  doubts_ = better ? doubts_ + 1 : 0;
  if (doubts_ < (moves ? 1 : kDoubts)) return;
  plane_ = other;
  followed_ = 1;
  doubts_ = 0;
}

Isometry3 FloorFinder::floorFromCamera() const {
  Isometry3 result = Isometry3::Identity();
  if (!found_) {
    result.translation().y() = 1.2;
    return result;
  }
  const Vec3 backward = (Vec3::UnitZ() - plane_.up.z() * plane_.up).normalized();
  Mat3 rows;
  rows.row(0) = plane_.up.cross(backward).transpose();
  rows.row(1) = plane_.up.transpose();
  rows.row(2) = backward.transpose();
  result.linear() = rows;
  result.translation().y() = plane_.height;
  return result;
}

WallFinder::WallFinder(const DepthGrid& grid)
    : tolerance_([](double depth) { return 0.02F + 2.5F * depthNoise(depth); }) {
  samples_.reserve(planeSampleCount(grid));
  smooth_.reserve(planeSampleCount(grid));
  planes_.reserve(kWalls);
}

void WallFinder::takeSamples(const DepthGrid& grid) {
  samples_.clear();
  visitPlaneSamples(grid, [&](std::uint16_t depthMm, const Vec3f& position, const PlaneArms& arms) {
    Sample& sample = samples_.emplace_back();
    sample.position = position;
    sample.tolerance = tolerance_[depthMm];
    if (!arms.seen()) return;
    const float bend = std::max(std::abs(0.5F * (arms.left.z() + arms.right.z()) - position.z()),
                                std::abs(0.5F * (arms.above.z() + arms.below.z()) - position.z()));
    const Vec3f normal = arms.normal();
    if (bend < 2.0F * sample.tolerance && normal.norm() > 1e-9F) sample.normal = normal.normalized();
  });
}

bool WallFinder::isOn(const Plane& plane, const Sample& sample) {
  return std::abs(plane.distance(sample.position)) < sample.tolerance && plane.normal.dot(sample.normal) > kAligned;
}

double WallFinder::score(const Plane& plane) const {
  int on = 0, behind = 0;
  for (const Sample& sample : samples_) {
    on += !sample.taken && isOn(plane, sample);
    behind += plane.distance(sample.position) < -kBehindWall - 2.0F * sample.tolerance;
  }
  const double all = samples_.size();
  return on - kBehindPenalty * std::max(0.0, behind - kBehindAllowed * all);
}

bool WallFinder::refine(Plane& plane) const {
  PlaneMoments moments;
  for (const std::uint32_t i : smooth_) {
    const Sample& sample = samples_[i];
    if (!isOn(plane, sample)) continue;
    moments.add(sample.position.cast<double>(), 1.0 / (sample.tolerance * sample.tolerance));
  }
  if (moments.count() == 0) return false;
  const PlaneMoments::Fit fit = moments.fit();
  if (fit.extent < kMinExtent) return false;
  const Vec3 normal = fit.normal.dot(fit.middle) > 0.0 ? Vec3(-fit.normal) : fit.normal;
  plane = {normal.cast<float>(), static_cast<float>(-normal.dot(fit.middle))};
  return true;
}

bool WallFinder::detect(const Vec3f& up, Plane& plane) {
  smooth_.clear();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Sample& sample = samples_[i];
    const bool upright = sample.normal != Vec3f::Zero() && std::abs(sample.normal.dot(up)) < kMaxSlope;
    if (!sample.taken && upright) smooth_.push_back(i);
  }
  const double least = std::max(kMinCount, kMinShare * samples_.size());
  if (smooth_.size() < least) return false;
  const auto positionOf = [&](std::size_t i) { return samples_[smooth_[i]].position; };
  const auto planeThrough = [&](const std::array<Vec3f, 3>& corners) -> std::optional<Plane> {
    Vec3f normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (normal.norm() < 0.01F) return std::nullopt;
    normal.normalize();
    if (std::abs(normal.dot(up)) > kMaxSlope) return std::nullopt;
    if (normal.dot(corners[0]) > 0.0F) normal = -normal;
    return Plane{normal, -normal.dot(corners[0])};
  };
  const double best = bestPlane(
      static_cast<std::uint64_t>(frameCount_) + 1, smooth_.size(), positionOf, planeThrough,
      [&](const Plane& tried) { return score(tried); }, plane);
  if (best < 0.5 * least) return false;
  for (int i = 0; i < 2; ++i) {
    if (!refine(plane)) return false;
  }
  return score(plane) >= least;
}

void WallFinder::update(const DepthGrid& grid, const Vec3f& up, bool moves) {
  if (moves) {
    planes_.clear();
    frameCount_ = 0;
    return;
  }
  if (frameCount_++ % kPause != 0) return;
  takeSamples(grid);
  planes_.clear();
  Plane plane;
  while (planes_.size() < kWalls && detect(up, plane)) {
    planes_.push_back(plane);
    for (Sample& sample : samples_) sample.taken = sample.taken || isOn(plane, sample);
  }
}

void WallFinder::mark(const DepthGrid& grid, std::span<CellKind> kinds) const {
  if (planes_.empty()) return;
  for (int r = 0; r < grid.height; ++r) {
    for (int c = 0; c < grid.width; ++c) {
      const std::size_t i = grid.index(c, r);
      const std::uint16_t depthMm = grid.depthMm[i];
      if (depthMm == 0 || kinds[i] == CellKind::kFloor) continue;
      const Vec3f at = grid.positionOf(c, r);
      const auto isNear = [&](const Plane& plane) { return std::abs(plane.distance(at)) < tolerance_[depthMm]; };
      if (std::ranges::any_of(planes_, isNear)) kinds[i] = CellKind::kWall;
    }
  }
}

}  // namespace lorica
