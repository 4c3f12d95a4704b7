#pragma once

#include "collision/world/world.h"

#include <cstdint>

namespace lorica {

/// What a person at the window does to the world. Whatever is done goes through Session::act(), in this form, so that a
/// session can be recorded and run again.
struct WorldAction {
  enum class Kind : std::uint8_t { kThrowBall, kGrab, kMoveGrab, kRelease };

  Kind kind = Kind::kRelease;
  int prop = 0;                  ///< grabbed: of World::props()
  Vec3 place = Vec3::Zero();     ///< ball: its middle; grab and move: the place that is held, world [m]
  Vec3 velocity = Vec3::Zero();  ///< ball [m/s]
  double radius = 0.0;           ///< ball [m]

  static WorldAction throwBall(const Vec3& place, const Vec3& velocity, double radius);
  /// Holds a prop at a place on it. What was held before is released.
  static WorldAction grab(int prop, const Vec3& place);
  static WorldAction moveGrab(const Vec3& place);
  static WorldAction release();
};
inline constexpr int kWorldActionKinds = 4;

/// Thrown balls are not larger than this [m], nor faster than this [m/s], nor farther than this from the origin [m].
inline constexpr double kLargestBall = 1.0, kFastestBall = 100.0, kFarthestPlace = 1000.0;

/// Whether an action can be done in a world: numbers that are finite and within these bounds, a prop that is there.
[[nodiscard]] bool canBeDone(const WorldAction& action, const World& world);

/// Does it, at once. @param action  that can be done
void apply(const WorldAction& action, World& world);

}  // namespace lorica
