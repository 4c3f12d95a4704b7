#include "capture/tracking/people/walls.h"

#include "capture/tracking/people/plane_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica {
namespace {

constexpr int kPause = 15;          // frames between searches
constexpr std::size_t kWalls = 3;   // at most
constexpr double kMinShare = 0.05;  // of the samples
constexpr double kMinCount = 120;
constexpr double kMinExtent = 0.25;      // standard deviation along the shorter side [m]; less may be a person's trunk
constexpr float kMaxSlope = 0.5F;        // sine of the angle between a wall and the vertical
constexpr float kAligned = 0.85F;        // least cosine of the angle between a sample's and the wall's normal
constexpr float kBehind = 0.10F;         // farther than this behind a wall lies what refutes it [m]
constexpr double kBehindPenalty = 8.0;   // samples on the plane that outweigh one behind it
constexpr double kBehindAllowed = 0.02;  // of the samples: through doors, windows and mirrors

}  // namespace

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
    behind += plane.distance(sample.position) < -kBehind - 2.0F * sample.tolerance;
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

void WallFinder::update(const DepthGrid& grid, const Vec3f& up) {
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
  for (const Plane& plane : planes_) {
    for (int r = 0; r < grid.height; ++r) {
      for (int c = 0; c < grid.width; ++c) {
        const std::size_t i = grid.index(c, r);
        const std::uint16_t depthMm = grid.depthMm[i];
        if (depthMm == 0 || kinds[i] == CellKind::kFloor) continue;
        if (std::abs(plane.distance(grid.positionOf(c, r))) < tolerance_[depthMm]) kinds[i] = CellKind::kWall;
      }
    }
  }
}

}  // namespace lorica
