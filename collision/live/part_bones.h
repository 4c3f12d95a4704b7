#pragma once

#include "acd/decomposition.h"
#include "skinning/character.h"

#include <vector>

namespace lorica {

struct BoneShare;

/// Share of a part's surface that a joint moves.
struct JointShare {
  JointIndex joint = 0;  ///< that moves the part
  double share = 0.0;    ///< above 0, at most 1
};

/// The joints that move each part of a character. A joint's share is the area of the part's surface in the bind pose,
/// weighted with the joint's blend weights. Caps do not count because they are not part of the character's surface. The
/// shares of a part add up to 1 and are sorted in descending order; joints without a share are omitted.
/// @param decomposition  of the character's mesh
/// @return the joints of each part; none for a part without surface
[[nodiscard]] std::vector<std::vector<JointShare>> jointsOfParts(const Decomposition& decomposition,
                                                                 const Character& character);

/// The same with the names of the joints, as stored in .lorica files: see acd/decomposition_file.h.
[[nodiscard]] std::vector<std::vector<BoneShare>> bonesOfParts(const Decomposition& decomposition,
                                                               const Character& character);

}  // namespace lorica
