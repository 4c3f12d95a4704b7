#include "capture/tracking/walls.h"

#include "geometry/random_numbers.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica {
namespace {

constexpr int kSpacing = 4;         // cells between samples
constexpr int kArm = 4;             // cells from a sample to the cells that define its normal
constexpr int kTries = 96;          // planes tried for one wall
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
    : tolerance_([](double depth) { return 0.02F + 2.5F * depthNoise(static_cast<float>(depth)); }) {
  const auto count =
      static_cast<std::size_t>(grid.width / kSpacing + 1) * static_cast<std::size_t>(grid.height / kSpacing + 1);
  samples_.reserve(count);
  smooth_.reserve(count);
  planes_.reserve(kWalls);
}

void WallFinder::takeSamples(const DepthGrid& grid) {
  samples_.clear();
  for (int r = kArm; r + kArm < grid.height; r += kSpacing) {
    for (int c = kArm; c + kArm < grid.width; c += kSpacing) {
      const std::uint16_t depthMm = grid.depthMm[grid.index(c, r)];
      if (depthMm == 0) continue;
      Sample& sample = samples_.emplace_back();
      sample.position = grid.positionOf(c, r);
      sample.tolerance = tolerance_[depthMm];
      const auto left = grid.positionOf(c - kArm, r), right = grid.positionOf(c + kArm, r);
      const auto above = grid.positionOf(c, r - kArm), below = grid.positionOf(c, r + kArm);
      if (left.z() == 0.0F || right.z() == 0.0F || above.z() == 0.0F || below.z() == 0.0F) continue;
      const float bend = std::max(std::abs(0.5F * (left.z() + right.z()) - sample.position.z()),
                                  std::abs(0.5F * (above.z() + below.z()) - sample.position.z()));
      const Vec3f normal = (right - left).cross(above - below);
      if (bend < 2.0F * sample.tolerance && normal.norm() > 1e-9F) sample.normal = normal.normalized();
    }
  }
}

bool WallFinder::isOn(const Plane& plane, const Sample& sample) {
  return std::abs(plane.distance(sample.position)) < sample.tolerance && plane.normal.dot(sample.normal) > kAligned;
}

double WallFinder::score(const Plane& plane) const {
  int on = 0, behind = 0;
  for (const Sample& sample : samples_) {
    on += static_cast<int>(!sample.taken && isOn(plane, sample));
    behind += static_cast<int>(plane.distance(sample.position) < -kBehind - 2.0F * sample.tolerance);
  }
  const auto all = static_cast<double>(samples_.size());
  return on - kBehindPenalty * std::max(0.0, behind - kBehindAllowed * all);
}

bool WallFinder::refine(Plane& plane) const {
  double weights = 0.0;
  Vec3 sum = Vec3::Zero();
  Mat3 products = Mat3::Zero();
  for (const std::uint32_t i : smooth_) {
    const Sample& sample = samples_[i];
    if (!isOn(plane, sample)) continue;
    const Vec3 position = sample.position.cast<double>();
    const double weight = 1.0 / static_cast<double>(sample.tolerance * sample.tolerance);
    weights += weight;
    sum += weight * position;
    products += weight * position * position.transpose();
  }
  if (weights == 0.0) return false;
  const Vec3 middle = sum / weights;
  const SymmetricAxes axes = symmetricAxes(Mat3(products / weights - middle * middle.transpose()));
  if (std::sqrt(std::max(0.0, axes.values[1])) < kMinExtent) return false;
  Vec3 normal = axes.vectors.col(0);
  if (normal.dot(middle) > 0.0) normal = -normal;
  plane = {normal.cast<float>(), static_cast<float>(-normal.dot(middle))};
  return true;
}

bool WallFinder::detect(const Vec3f& up, Plane& plane) {
  smooth_.clear();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Sample& sample = samples_[i];
    const bool upright = sample.normal != Vec3f::Zero() && std::abs(sample.normal.dot(up)) < kMaxSlope;
    if (!sample.taken && upright) smooth_.push_back(static_cast<std::uint32_t>(i));
  }
  const double least = std::max(kMinCount, kMinShare * static_cast<double>(samples_.size()));
  const auto count = static_cast<double>(smooth_.size());
  if (count < least) return false;
  RandomNumbers random(static_cast<std::uint64_t>(frameCount_) + 1);
  double best = 0.0;
  for (int i = 0; i < kTries; ++i) {
    std::array<Vec3f, 3> p;
    for (Vec3f& position : p) position = samples_[smooth_[static_cast<std::size_t>(random.unit() * count)]].position;
    Vec3f normal = (p[1] - p[0]).cross(p[2] - p[0]);
    if (normal.norm() < 0.01F) continue;
    normal.normalize();
    if (std::abs(normal.dot(up)) > kMaxSlope) continue;
    if (normal.dot(p[0]) > 0.0F) normal = -normal;
    const Plane tried{normal, -normal.dot(p[0])};
    const double value = score(tried);
    if (value <= best) continue;
    best = value;
    plane = tried;
  }
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
