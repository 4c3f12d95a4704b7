#pragma once

#include "capture/skeleton_frame.h"

#include <cstdint>
#include <string_view>
#include <vector>

namespace lorica {

/// A procedurally generated motion of the built-in figure.
enum class SyntheticMotion : std::uint8_t {
  kWalk,
  kWave,
  kJumpingJacks,
  kSquatAndReach,
  kPunchAndKick,
  kTurnAround,
};
inline constexpr int kSyntheticMotionCount = 6;

/// "walk", "jumping_jacks", ...: the stem of the shipped file.
[[nodiscard]] std::string_view nameOf(SyntheticMotion motion);

/// Joints of a person of about 1.75 m at 30 Hz, without noise, every confidence 1. The same on every machine.
[[nodiscard]] std::vector<SkeletonFrame> synthesizeMotion(SyntheticMotion motion);

/// Rounds as the shipped files do: to 0.01 mm, 0.00001 of a quaternion component and 1 us. That is finer than any
/// tracker, and keeps files small.
void roundForFile(std::vector<SkeletonFrame>& frames);

}  // namespace lorica
