#include "capture/tracking/people/background.h"

#include <algorithm>
#include <cmath>

namespace lorica {

namespace {

constexpr std::uint8_t kFullTrust = 40;
constexpr std::uint8_t kReplaceAfter = 45;  // frames that something nearer must stay
constexpr std::uint8_t kDeeperAfter = 3;    // frames that something deeper must be seen
constexpr int kFirstFrames = 5;             // in these, everything that belongs to nobody is learnt at once
constexpr float kNotKnown = 1e6F;

}  // namespace

Background::Background(const DepthGrid& grid)
    : width_(grid.width),
      height_(grid.height),
      depth_(grid.cellCount()),
      trust_(grid.cellCount()),
      candidate_(grid.cellCount()),
      seen_(grid.cellCount()),
      nearest_(grid.cellCount(), kNotKnown),
      rowNearest_(grid.cellCount(), kNotKnown),
      tolerance_([](double depth) { return 0.012F + 3.0F * depthNoise(depth); }) {}

void Background::classify(const DepthGrid& grid, std::span<CellKind> kinds) const {
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const std::uint16_t depthMm = grid.depthMm[i];
    if (depthMm == 0) {
      kinds[i] = CellKind::kNone;
      continue;
    }
    if (kinds[i] == CellKind::kFloor || kinds[i] == CellKind::kWall) continue;
    const float known = depth_[i];
    if (known == 0.0F) {
      kinds[i] = CellKind::kUnknown;
      continue;
    }
    const float tolerance = 1000.0F * tolerance_[depthMm];
    const float depth = depthMm;
    if (depth > known + tolerance) {
      kinds[i] = CellKind::kUnknown;
    } else {
      kinds[i] = depth < nearest_[i] - tolerance ? CellKind::kNew : CellKind::kBackground;
    }
  }
}

void Background::absorb(const DepthGrid& grid, std::size_t cell) {
  if (grid.depthMm[cell] == 0) return;
  depth_[cell] = grid.depthMm[cell];
  trust_[cell] = 1;
  seen_[cell] = 0;
}

void Background::forget(std::size_t cell) {
  depth_[cell] = 0.0F;
  trust_[cell] = seen_[cell] = 0;
}

void Background::forget() {
  for (std::size_t i = 0; i < depth_.size(); ++i) forget(i);
  frameCount_ = 0;
}

void Background::learn(const DepthGrid& grid, std::span<const CellKind> kinds, std::span<const std::uint8_t> taken) {
  const bool first = frameCount_++ < kFirstFrames;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const std::uint16_t depthMm = grid.depthMm[i];
    if (depthMm == 0 || taken[i] != 0) continue;
    const float tolerance = 1000.0F * tolerance_[depthMm];
    const float depth = depthMm;
    const float off = depth - depth_[i];
    if (depth_[i] != 0.0F && std::abs(off) <= tolerance) {
      if (trust_[i] < kFullTrust) ++trust_[i];
      depth_[i] += off / (trust_[i] + 1);
      seen_[i] = 0;
      continue;
    }
    if (depth_[i] == 0.0F && (first || kinds[i] == CellKind::kFloor)) {
      absorb(grid, i);
      continue;
    }
    if (std::abs(depth - candidate_[i]) > tolerance) {
      candidate_[i] = depthMm;
      seen_[i] = 0;
    } else if (seen_[i] < 255) {
      ++seen_[i];
    }
    // Nothing exists behind the background: what was taken for background has moved away.
    const bool left = depth_[i] != 0.0F && off > 0.0F;
    if (seen_[i] >= (left ? kDeeperAfter : kReplaceAfter)) absorb(grid, i);
  }
  findNearest();
}

void Background::findNearest() {
  const std::size_t w = width_;
  const auto value = [](float depth) { return depth == 0.0F ? kNotKnown : depth; };
  for (int r = 0; r < height_; ++r) {
    const float* row = depth_.data() + r * w;
    float* out = rowNearest_.data() + r * w;
    out[0] = std::min(value(row[0]), value(row[1]));
    for (std::size_t c = 1; c + 1 < w; ++c) out[c] = std::min({value(row[c - 1]), value(row[c]), value(row[c + 1])});
    out[w - 1] = std::min(value(row[w - 2]), value(row[w - 1]));
  }
  for (int r = 0; r < height_; ++r) {
    const float* above = rowNearest_.data() + std::max(r - 1, 0) * w;
    const float* row = rowNearest_.data() + r * w;
    const float* below = rowNearest_.data() + std::min(r + 1, height_ - 1) * w;
    float* out = nearest_.data() + r * w;
    for (std::size_t c = 0; c < w; ++c) out[c] = std::min({above[c], row[c], below[c]});
  }
}

}  // namespace lorica
