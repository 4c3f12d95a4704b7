#pragma once

#include "skinning/character.h"

namespace lorica {

/// How a body differs from the one that it is made of; all are factors.
struct BodyProportions {
  double height = 1.0;  ///< of everything
  double girth = 1.0;   ///< of limbs and trunk around their bones; joints stay where they are
  double arms = 1.0;    ///< lengths of upper arms and forearms
  double legs = 1.0;    ///< lengths of thighs and shins
  double trunk = 1.0;   ///< length from the hips to the neck

  friend bool operator==(const BodyProportions&, const BodyProportions&) = default;
};

/// Another body: mesh, bind pose and rest pose changed alike, the lowest vertex as high above the floor as before.
/// @param character    with humanoid bones; bones that it lacks are not changed
/// @param proportions  all above 0
[[nodiscard]] Character withProportions(const Character& character, const BodyProportions& proportions);

}  // namespace lorica
