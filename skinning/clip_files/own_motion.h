#pragma once

#include "skinning/clip.h"
#include "skinning/import/character_file.h"

#include <vector>

namespace lorica {

/// A motion of the joints that a character's file has, without the first one of CharacterFile, which converts the
/// file's units and axes. Other joints that were added stay.
struct OwnMotion {
  SkeletalMotion motion;
  std::vector<int> nodeOfJoint;  ///< as in CharacterFile
};

/// In the file's units and axes: joints keep the file's numbers.
[[nodiscard]] OwnMotion inFileUnits(const CharacterFile& file, const SkeletalMotion& motion);

/// In metres, Y up.
[[nodiscard]] OwnMotion inMetres(const CharacterFile& file, const SkeletalMotion& motion);

/// A motion without the joints of CharacterFile that repeat another one because it has several bind matrices.
[[nodiscard]] SkeletalMotion withoutCopies(const OwnMotion& own);

}  // namespace lorica
