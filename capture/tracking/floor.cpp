#include "capture/tracking/floor.h"

#include "geometry/random_numbers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lorica {

namespace {

constexpr int kSpacing = 4;       // cells between samples
constexpr int kArm = 4;           // cells from a sample to the cells that define its normal
constexpr int kTries = 96;        // planes tried
constexpr double kMinLevel = 60;  // min samples on a floor
constexpr double kMaxTilt = 40.0 * EIGEN_PI / 180.0;
constexpr double kMaxRoll = 20.0 * EIGEN_PI / 180.0;

}  // namespace

FloorFinder::FloorFinder(const DepthGrid& grid) {
  const auto count =
      static_cast<std::size_t>(grid.width / kSpacing + 1) * static_cast<std::size_t>(grid.height / kSpacing + 1);
  samples_.reserve(count);
  level_.reserve(count);
}

void FloorFinder::takeSamples(const DepthGrid& grid) {
  samples_.clear();
  level_.clear();
  for (int r = kArm; r + kArm < grid.height; r += kSpacing) {
    for (int c = kArm; c + kArm < grid.width; c += kSpacing) {
      if (grid.depthMm[grid.index(c, r)] == 0) continue;
      const Vec3f position = grid.positionOf(c, r);
      const float depth = -position.z();
      // The height error is the depth error times the slope of the ray, which is the camera's height over the depth.
      Sample sample{position, 2.5F * depthNoise(depth) / depth, false};
      const auto left = grid.positionOf(c - kArm, r), right = grid.positionOf(c + kArm, r);
      const auto above = grid.positionOf(c, r - kArm), below = grid.positionOf(c, r + kArm);
      if (left.z() != 0.0F && right.z() != 0.0F && above.z() != 0.0F && below.z() != 0.0F) {
        const Vec3f normal = (right - left).cross(above - below);
        const bool smooth =
            std::abs(right.z() - left.z()) < 0.15F * depth && std::abs(above.z() - below.z()) < 0.3F * depth;
        sample.level = smooth && normal.y() > 0.7F * normal.norm();
      }
      if (sample.level) level_.push_back(static_cast<std::uint32_t>(samples_.size()));
      samples_.push_back(sample);
    }
  }
}

bool FloorFinder::sensible(const Plane& plane) const {
  return plane.height >= 0.3 && plane.height <= 2.5 && plane.up.y() >= std::cos(kMaxTilt) &&
         std::abs(plane.up.x()) <= std::sin(kMaxRoll);
}

double FloorFinder::score(const Plane& plane) const {
  const Vec3f up = plane.up.cast<float>();
  const auto height = static_cast<float>(plane.height);
  int on = 0, under = 0;
  for (const Sample& s : samples_) {
    const float above = up.dot(s.position) + height;
    const float tolerance = 0.015F + s.tolerance * height;
    on += static_cast<int>(s.level && std::abs(above) < tolerance);
    under += static_cast<int>(above < -0.06F - 2.0F * tolerance);
  }
  // Mirrors and windows show a few points below any floor.
  return on - 40.0 * std::max(0.0, under - 0.003 * static_cast<double>(samples_.size()));
}

bool FloorFinder::refine(Plane& plane) const {
  const double height = plane.height;
  double weights = 0.0, count = 0.0;
  Vec3 sum = Vec3::Zero();
  Mat3 products = Mat3::Zero();
  for (const std::uint32_t i : level_) {
    const Sample& s = samples_[i];
    const Vec3 position = s.position.cast<double>();
    const double tolerance = 0.015 + s.tolerance * height;
    if (std::abs(plane.up.dot(position) + height) >= tolerance) continue;
    const double weight = 1.0 / (tolerance * tolerance);
    weights += weight;
    count += 1.0;
    sum += weight * position;
    products += weight * position * position.transpose();
  }
  if (count < kMinLevel) return false;
  const Vec3 middle = sum / weights;
  const SymmetricAxes axes = symmetricAxes(Mat3(products / weights - middle * middle.transpose()));
  // A smaller extent is the top of an object.
  if (std::sqrt(std::max(0.0, axes.values[1])) < 0.1) return false;
  Vec3 up = axes.vectors.col(0);
  if (up.y() < 0.0) up = -up;
  plane = {up, -up.dot(middle)};
  return sensible(plane);
}

bool FloorFinder::detect(Plane& plane) {
  const auto count = static_cast<std::uint32_t>(level_.size());
  if (count < kMinLevel) return false;
  RandomNumbers random(static_cast<std::uint64_t>(frameCount_) + 1);
  double best = 0.0;
  for (int i = 0; i < kTries; ++i) {
    std::array<Vec3, 3> p;
    for (Vec3& position : p) position = samples_[level_[random.unit() * count]].position.cast<double>();
    const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
    if (normal.norm() < 0.01) continue;
    Plane tried{normal.normalized(), 0.0};
    if (tried.up.y() < 0.0) tried.up = -tried.up;
    tried.height = -tried.up.dot(p[0]);
    if (!sensible(tried)) continue;
    const double value = score(tried);
    if (value <= best) continue;
    best = value;
    plane = tried;
  }
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
