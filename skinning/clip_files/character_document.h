#pragma once

#include "skinning/clip_files/character_clip.h"
#include "skinning/clip_files/gltf_writer.h"

#include <string>
#include <vector>

namespace lorica {

/// A character's GLB before it is written, for those who add to it.
struct CharacterDocument {
  GltfWriter writer;
  std::vector<int> nodeOfJoint;        ///< -1: the joint is no node, see nodeFrame
  std::vector<Affine3> nodeFromModel;  ///< for each joint: from model space in the bind pose to its node's, or to the
                                       ///< scene's if the joint hangs on no node
  std::vector<int> hangOn;             ///< for each joint: its node, else that of the next joint above; -1: the scene
  std::vector<std::string> notes;      ///< a sentence for each picture that was not found
};

/// Whether a file is glTF, GLB or VRM, so that the output is that file with something more.
[[nodiscard]] bool isOfGltf(const CharacterFile& file);

/// The file of a glTF, GLB or VRM character, complete and in its own units; of any other character what Lorica has
/// read, in metres, Y up. See writeClip().
[[nodiscard]] Result<CharacterDocument> characterDocument(const ClipCharacter& from);
/// The same of a character without a file, such as the mannequin.
[[nodiscard]] CharacterDocument characterDocument(const Character& character);

}  // namespace lorica
