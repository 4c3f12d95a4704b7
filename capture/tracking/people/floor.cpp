#include "capture/tracking/people/floor.h"

#include "capture/tracking/people/plane_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica {

namespace {

constexpr double kMinLevel = 60;  // min samples on a floor
constexpr double kMaxTilt = 40.0 * EIGEN_PI / 180.0;
constexpr double kMaxRoll = 20.0 * EIGEN_PI / 180.0;

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

void FloorFinder::update(const DepthGrid& grid) {
  takeSamples(grid);
  const int frame = frameCount_++;
  if (!found_) {
    // A floor may come into view at any time; searching for it costs more than everything else.
    if (frame >= 10 && frame % 10 != 0) return;
    found_ = detect(plane_);
    followed_ = 1;
    return;
  }
  Plane now = plane_;
  if (refine(now)) {
    const double share = std::max(1.0 / (1.0 + followed_), 0.02);
    plane_.up = (plane_.up + share * (now.up - plane_.up)).normalized();
    plane_.height += share * (now.height - plane_.height);
    ++followed_;
  }
  if (frame % 15 != 0) return;
  // The camera was moved, or the plane taken for the floor turns out to have something below it.
  Plane other;
  const bool better = detect(other) && score(other) > 1.5 * std::max(0.0, score(plane_)) + kMinLevel;
  doubts_ = better ? doubts_ + 1 : 0;
  if (doubts_ < 3) return;
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

}  // namespace lorica
