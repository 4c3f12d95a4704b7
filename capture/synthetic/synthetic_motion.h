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

/// Seed of the shipped *_noisy.csv.
inline constexpr std::uint64_t kSensorNoiseSeed = 2026;

/// "walk", "jumping_jacks", ...: the stem of the shipped file.
[[nodiscard]] std::string_view nameOf(SyntheticMotion motion);

/// Joints of a person of about 1.75 m at 30 Hz, without noise, every confidence 1. The same on every machine.
[[nodiscard]] std::vector<SkeletonFrame> synthesizeMotion(SyntheticMotion motion);

/// Rounds as the shipped files do: to 0.01 mm, 0.00001 of a quaternion component and 1 us. That is finer than any
/// tracker, and keeps files small.
void roundForFile(std::vector<SkeletonFrame>& frames);

/// Adds the errors of a depth sensor at (0, 1.1, 3.2): jitter that increases with distance, limbs lost for 0.1 to 1 s
/// (confidence 0, stale position, no orientation), guesses before and after (0.5). Same seed, same result.
[[nodiscard]] std::vector<SkeletonFrame> addSensorNoise(std::vector<SkeletonFrame> frames, std::uint64_t seed);

}  // namespace lorica
