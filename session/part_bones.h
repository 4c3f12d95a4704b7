#pragma once

#include "acd/decomposition_file.h"
#include "skinning/character.h"

#include <vector>

namespace lorica {

/// How much of a part a joint moves.
struct JointShare {
  JointIndex joint = 0;
  double share = 0.0;  ///< above 0, at most 1
};

/// The joints that move each part of a character: of the part's surface in the bind pose, the share that each joint
/// moves, area times blend weight. Caps do not count, for they are not of the character. Shares of a part add up to 1,
/// the largest comes first; joints that move nothing are left out.
/// @param decomposition  of the character's mesh
/// @return for each part its joints; none where a part has no surface
[[nodiscard]] std::vector<std::vector<JointShare>> jointsOfParts(const Decomposition& decomposition,
                                                                 const Character& character);

/// The same by the names of the joints, as .lorica files keep it.
[[nodiscard]] std::vector<std::vector<BoneShare>> bonesOfParts(const Decomposition& decomposition,
                                                               const Character& character);

}  // namespace lorica
