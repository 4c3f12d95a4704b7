#pragma once

#include "skinning/character.h"

namespace lorica {

/// The built-in character: a human figure of about 1.75 m in T-pose, feet on y = 0, facing +Z.
/// A closed two-manifold of 8,000 to 15,000 vertices; joints named after VRM's humanoid bones, fingers included;
/// at most four influences per vertex. Identical on every machine.
[[nodiscard]] Character makeMannequin();

}  // namespace lorica
