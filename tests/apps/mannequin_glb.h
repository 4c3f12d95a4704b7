#pragma once

#include <string>

namespace lorica::test {

/// What a user's file of the built-in character might look like: a GLB in T-pose with bones named as Mixamo does, four
/// influences a vertex, and two clips, "Bow" of 1 s and "Nod" of 0.5 s.
/// @param torn  without some of its triangles, so that it is open
/// @param named  false: bones have numbers instead of names, and stand in centimetres in a turned, scaled armature
[[nodiscard]] std::string mannequinGlb(bool torn, bool named = true);

}  // namespace lorica::test
