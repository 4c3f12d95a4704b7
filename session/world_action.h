#pragma once

#include "collision/world/world.h"

#include <cstdint>

namespace lorica {

/// An interaction of the user with the world. All interactions are applied through Session::act() in this form, so that
/// a session can be recorded and replayed.
struct WorldAction {
  enum class Kind : std::uint8_t { kThrowBall, kGrab, kMoveGrab, kRelease };

  Kind kind = Kind::kRelease;
  int prop = 0;                  ///< grab: index in World::props()
  Vec3 position = Vec3::Zero();  ///< ball: its centre; grab and move: the held point, world [m]
  Vec3 velocity = Vec3::Zero();  ///< ball, and released prop: 0 = its own [m/s]
  double radius = 0.0;           ///< ball [m]
  int hand = 0;                  ///< grab, move and release: see World::grab()

  static WorldAction throwBall(const Vec3& position, const Vec3& velocity, double radius);
  /// Grabs a prop at a point on it. What this hand held before is released.
  static WorldAction grab(int prop, const Vec3& position, int hand = 0);
  static WorldAction moveGrab(const Vec3& position, int hand = 0);
  static WorldAction release(const Vec3& velocity = Vec3::Zero(), int hand = 0);
};
inline constexpr int kWorldActionKinds = 4;

/// Limits: radius [m] and speed [m/s] of what is thrown, and the absolute value of each coordinate of a position [m].
inline constexpr double kLargestBall = 1.0, kFastestBall = 100.0, kFarthestPosition = 1000.0;

/// Whether an action is possible in a world: its numbers are finite and within the limits, and prop and hand exist.
[[nodiscard]] bool canBeDone(const WorldAction& action, const World& world);

/// Applies the action at once. @param action  for which canBeDone() is true
void apply(const WorldAction& action, World& world);

}  // namespace lorica
