#pragma once

#include "geometry/named_file.h"
#include "geometry/result.h"
#include "skinning/clip.h"
#include "skinning/import/character_file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace lorica {

/// A character and the file that it was read from.
struct ClipCharacter {
  std::filesystem::path path;
  const CharacterFile* file = nullptr;
  PathTrust paths = PathTrust::kBeneath;  ///< which files it may name
};

/// Writes a .glb of a character in motion, completely or not at all. The motion is its first animation, with linear
/// keys at the motion's frames, from time 0; joints have their names and their rest pose.
///
/// A character of a glTF, GLB or VRM file: the output is that file, in its own units, with one animation more. Other
/// buffers and pictures that it refers to become part of it. Of any other file: in metres, Y up, what Lorica has read
/// of it: joints, mesh, weights, materials and pictures; no morph targets and no clips of its own.
/// @param motion  of the character's skeleton
/// @return a sentence for each picture that was not found; or an error if a number is not finite, a joint moves whose
/// node is sheared, or the output cannot be written
[[nodiscard]] Result<std::vector<std::string>> writeClip(const std::filesystem::path& out, const ClipCharacter& from,
                                                         const SkeletalMotion& motion);

/// The same of a character without a file, such as the mannequin.
[[nodiscard]] Result<void> writeClip(const std::filesystem::path& out, const Character& character,
                                     const SkeletalMotion& motion);

}  // namespace lorica
