#include "capture/tracking/people/camera_motion.h"

#include <algorithm>
#include <cstdlib>

namespace lorica {
namespace {

constexpr int kFrames = 8;           // over which a motion is looked for
constexpr float kChanged = 0.1F;     // of the cells that change in them, beside twice those that change in a frame
constexpr double kStillAfter = 1.0;  // how long the camera must stand still [s]

}  // namespace

CameraMotion::CameraMotion(const DepthGrid& grid)
    : before_(grid.cellCount()),
      covered_(grid.cellCount()),
      tolerance_([](double depth) { return 0.012F + 3.0F * depthNoise(depth); }) {}

float CameraMotion::changedSince(const DepthGrid& grid, std::span<const std::uint16_t> before,
                                 std::span<const std::uint8_t> covered) const {
  int both = 0, changed = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const int now = grid.depthMm[i], was = before[i];
    if (now == 0 || was == 0 || covered[i] != 0 || covered_[i] != 0) continue;
    ++both;
    changed += static_cast<float>(std::abs(now - was)) > 1000.0F * tolerance_[grid.depthMm[i]];
  }
  return static_cast<float>(changed) / static_cast<float>(std::max(both, 1));
}

bool CameraMotion::update(const DepthGrid& grid, std::span<const std::uint16_t> last,
                          std::span<const std::uint8_t> covered, double time) {
  if (age_ == kFrames) {
    const bool moved = changedSince(grid, before_, covered) > kChanged + 2.0F * changedSince(grid, last, covered);
    if (moved) until_ = time + kStillAfter;
    age_ = 0;
  }
  if (age_++ == 0) {
    before_ = grid.depthMm;
    std::ranges::copy(covered, covered_.begin());
  }
  return time < until_;
}

}  // namespace lorica
