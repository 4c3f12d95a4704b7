#pragma once

#include "capture/skeleton_frame.h"

#include <cstdint>
#include <string_view>
#include <vector>

namespace lorica {

/// A motion of the built-in figure, made by formula.
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

/// Joints of a person of about 1.75 m at 30 Hz, clean, every confidence 1. The same on every machine.
[[nodiscard]] std::vector<SkeletonFrame> synthesizeMotion(SyntheticMotion motion);

/// Adds what a depth sensor does: jitter that grows with distance, limbs lost for a while (confidence 0), guesses
/// (0.5).
[[nodiscard]] std::vector<SkeletonFrame> addSensorNoise(std::vector<SkeletonFrame> frames, std::uint64_t seed);

}  // namespace lorica
