#pragma once

#include "tests/skinning/import/glb_writer.h"

#include <string>

namespace lorica::test {

/// The built-in character as a typical user file: a GLB in T-pose with Mixamo bone names, four influences per vertex,
/// and two clips, "Bow" (1 s) and "Nod" (0.5 s).
/// @param torn   some triangles are missing, so that the surface is open
/// @param named  false: bones have numbers instead of names, and use centimetres in a rotated, scaled armature
[[nodiscard]] std::string mannequinGlb(bool torn, bool named = true);
/// The same before it is written, for tests that add to it. The mesh has the vertices of makeMannequin().
[[nodiscard]] GlbWriter mannequinWriter(bool torn, bool named = true);
/// The mannequin with a material and two targets, "Belly" forward by 12 cm and "Frown", which moves 1 mm; if asked for,
/// the clip "Breathe" moves the first.
[[nodiscard]] std::string facesGlb(bool breathes);

}  // namespace lorica::test
