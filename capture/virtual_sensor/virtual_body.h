#pragma once

#include "skinning/character.h"

namespace lorica {

/// Proportions of a body relative to the original; all are factors.
struct BodyProportions {
  double height = 1.0;  ///< overall
  double girth = 1.0;   ///< limbs and trunk around their bones; joints keep their positions
  double arms = 1.0;    ///< lengths of upper arms and forearms
  double legs = 1.0;    ///< lengths of thighs and shins
  double trunk = 1.0;   ///< length from the hips to the neck

  friend bool operator==(const BodyProportions&, const BodyProportions&) = default;
};

/// Returns a modified body: mesh, bind pose and rest pose change consistently, and the lowest vertex keeps its height
/// above the floor, relative to the body height.
/// @param character    with humanoid bones; missing bones are ignored
/// @param proportions  all above 0
[[nodiscard]] Character withProportions(const Character& character, const BodyProportions& proportions);

}  // namespace lorica
