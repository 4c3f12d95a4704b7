#pragma once

#include "acd/decomposition.h"
#include "skinning/character.h"

#include <random>
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

}  // namespace lorica::test
