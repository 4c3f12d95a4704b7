#pragma once

#include "acd/decomposition.h"
#include "skinning/character.h"

#include <random>
#include <vector>

namespace lorica::test {

/// The mannequin cut in eight parts for its bind pose, and poses to carry them to.
struct Dancer {
  Dancer();

  Character character;
  Decomposition decomposition;
  std::vector<Affine3> worldFromModel;  ///< of the present pose

  /// Turns every joint by up to `most` [rad] and puts the whole body somewhere within 5 m.
  void dance(std::mt19937_64& random, double most);

  /// Mesh vertices and cut points, by skinning and the recursion: the slow way.
  [[nodiscard]] std::vector<Vec3> points() const;
};

}  // namespace lorica::test
