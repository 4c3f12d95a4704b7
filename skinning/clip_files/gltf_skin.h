#pragma once

#include "skinning/character.h"
#include "skinning/clip_files/gltf_writer.h"
#include "skinning/look/look.h"

#include <map>
#include <set>
#include <span>
#include <string>

namespace lorica {

/// Materials, textures and the looks of vertices in a document. Toon materials become plain ones.
class GltfLook {
 public:
  GltfLook(GltfWriter& writer, const Look& look);

  /// A primitive of one group, without its triangles.
  /// @param attributes  those that all groups share
  [[nodiscard]] nlohmann::ordered_json primitiveOf(const LookGroup& group, const nlohmann::ordered_json& attributes);

 private:
  /// Textures are written when a material uses them. @return a textureInfo, or null if the texture has no picture
  [[nodiscard]] nlohmann::ordered_json textureInfo(const TextureUse& use);
  [[nodiscard]] int pictureIndex(int picture);
  [[nodiscard]] nlohmann::ordered_json materialOf(const Material& material);
  void addMaterials();
  void addVertexLists();
  void use(const char* extension);

  GltfWriter& writer_;
  const Look& look_;
  std::map<int, int> imageOf_;        ///< of each picture that was written
  nlohmann::ordered_json lists_;      ///< attributes beside positions and weights
  int normals_ = -1;                  ///< accessor
  std::set<std::string> extensions_;  ///< that the document uses
};

/// Adds a whole character: a node for each joint, in their order and at rest, and a node with the skinned mesh.
/// @param skeleton   of the joints to write
/// @param jointFromModel  inverse bind matrices of these joints
/// @param firstJoint      index in the character of the first of them; no vertex may follow an earlier one
/// @param look            of the character's mesh; may be empty
void addCharacter(GltfWriter& writer, const Character& character, const Look& look, const Skeleton& skeleton,
                  std::span<const Affine3> jointFromModel, JointIndex firstJoint);

}  // namespace lorica
