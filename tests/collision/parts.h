#pragma once

#include "acd/decomposition.h"
#include "collision/live/live_body.h"
#include "skinning/character.h"

#include <random>
#include <span>
#include <vector>

namespace lorica::test {

/// The mannequin cut into eight parts in its bind pose, and poses to move them to.
struct Dancer {
  Dancer();

  Character character;
  Decomposition decomposition;
  std::vector<Affine3> worldFromModel;  ///< of the present pose

  /// Rotates every joint by up to `max` [rad] and puts the whole body at a random position within 5 m.
  void dance(std::mt19937_64& random, double max);

  /// Mesh vertices and cut points, by skinning and the recursion: the slow reference.
  [[nodiscard]] std::vector<Vec3> points() const;
};

/// A box-shaped live part about its own origin, at rest in `worldFromPart`.
[[nodiscard]] LivePart makeBoxPart(const Vec3& halfExtents, const Isometry3& worldFromPart);

/// Gives a part other corners, in its own frame, and their hull in its present pose.
void reshape(LivePart& part, std::span<const Vec3> corners);
void reshapeToBox(LivePart& part, const Vec3& halfExtents);

/// The next frame: the part moves from its present pose to `worldFromPart`.
void moveTo(LivePart& part, const Isometry3& worldFromPart);

[[nodiscard]] Isometry3 at(double x, double y, double z);

/// Uniform rotation, and numbers from [low, high): the same on every machine.
[[nodiscard]] double uniform(std::mt19937_64& random, double low, double high);
[[nodiscard]] Vec3 uniformVec3(std::mt19937_64& random, double low, double high);
[[nodiscard]] Quat uniformRotation(std::mt19937_64& random);

}  // namespace lorica::test
