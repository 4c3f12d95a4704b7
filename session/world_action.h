#pragma once

#include "collision/world/world.h"

#include <cstdint>

namespace lorica {

/// An interaction of the user with the world. All interactions are applied through Session::act() in this form, so that
/// a session can be recorded and replayed.
struct WorldAction {
  /// What is done.
  enum class Kind : std::uint8_t { kThrowBall, kGrab, kMoveGrab, kRelease };

  Kind kind = Kind::kRelease;    ///< which of the numbers below count
  int prop = 0;                  ///< grab: index in World::props()
  Vec3 position = Vec3::Zero();  ///< ball: its centre; grab and move: the held point, world [m]
  Vec3 velocity = Vec3::Zero();  ///< ball, and released prop: 0 = its own [m/s]
  double radius = 0.0;           ///< ball [m]
  int hand = 0;                  ///< grab, move and release: see World::grab()

  /// Throws a ball. @param radius  [m].
  static WorldAction throwBall(const Vec3& position, const Vec3& velocity, double radius);
  /// Grabs a prop at a point on it. What this hand held before is released.
  static WorldAction grab(int prop, const Vec3& position, int hand = 0);
  /// Moves what a hand holds.
  static WorldAction moveGrab(const Vec3& position, int hand = 0);
  /// Lets go of it. @param velocity  with which it leaves; 0 = its own [m/s].
  static WorldAction release(const Vec3& velocity = Vec3::Zero(), int hand = 0);
};
inline constexpr int kWorldActionKinds = 4;  ///< actions that WorldAction::Kind names

// Limits: radius and speed of what is thrown, and the absolute value of each coordinate of a position.
inline constexpr double kLargestBall = 1.0;          ///< [m]
inline constexpr double kFastestBall = 100.0;        ///< [m/s]
inline constexpr double kFarthestPosition = 1000.0;  ///< [m]

/// Whether an action is possible in a world: its numbers are finite and within the limits, and prop and hand exist.
[[nodiscard]] bool canBeDone(const WorldAction& action, const World& world);

/// Applies the action at once. @param action  for which canBeDone() is true
void apply(const WorldAction& action, World& world);

}  // namespace lorica
