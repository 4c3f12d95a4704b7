#include "skinning/clip_files/character_document.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "skinning/clip_files/gltf_embedding.h"
#include "skinning/clip_files/gltf_skin.h"
#include "skinning/clip_files/own_motion.h"

namespace lorica {

namespace {

/// Joints that are no node, because the file's node has several bind matrices or is sheared, never move within their
/// parent: they hang on the nearest node above.
void hangOnNodes(CharacterDocument& document, const Character& character) {
  document.hangOn = document.nodeOfJoint;
  std::vector<Affine3> nodeFromJoint(document.hangOn.size(), Affine3::Identity());
  for (JointIndex j = 0; j < character.skeleton.jointCount(); ++j) {
    const Joint& joint = character.skeleton.joint(j);
    if (document.hangOn[j] >= 0 || joint.parent == kNoJoint) continue;
    document.hangOn[j] = document.hangOn[joint.parent];
    nodeFromJoint[j] = nodeFromJoint[joint.parent] * joint.rest.matrix();
    document.nodeFromModel[j] = nodeFromJoint[j] * character.jointFromModel[j];
  }
}

/// What Lorica has read of a character, as a document.
CharacterDocument readDocument(const Character& character, const Look& look, const Skeleton& skeleton,
                               std::span<const Affine3> jointFromModel) {
  CharacterDocument document;
  const int first = character.skeleton.jointCount() - skeleton.jointCount();
  addCharacter(document.writer, character, look, skeleton, jointFromModel, first);
  document.nodeOfJoint.assign(first, -1);
  document.nodeFromModel.assign(first, Affine3::Identity());
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) document.nodeOfJoint.push_back(j);
  document.nodeFromModel.insert(document.nodeFromModel.end(), jointFromModel.begin(), jointFromModel.end());
  document.hangOn = document.nodeOfJoint;
  return document;
}

Result<CharacterDocument> ownDocument(const ClipCharacter& from) {
  LORICA_TRY(const std::string content, readFile(from.path));
  const NamedFiles files{from.path.has_parent_path() ? from.path.parent_path() : ".", from.paths};
  CharacterDocument document;
  LORICA_TRY(GltfWriter writer,
             embedGltf(std::as_bytes(std::span(content)), from.path.string(), files, document.notes));
  document.writer = std::move(writer);
  document.nodeOfJoint = from.file->nodeOfJoint;
  document.nodeFromModel = from.file->character.jointFromModel;
  hangOnNodes(document, from.file->character);
  return document;
}

}  // namespace

bool isOfGltf(const CharacterFile& file) {
  return file.format.starts_with("glTF") || file.format.starts_with("VRM");
}

Result<CharacterDocument> characterDocument(const ClipCharacter& from) {
  if (isOfGltf(*from.file)) return ownDocument(from);
  const Character& character = from.file->character;
  if (!character.shapes.empty()) {
    return unsupported("{}: a mesh in several poses has no bones that a clip could move", from.path.string());
  }
  const Pose rest = restPose(character.skeleton);
  const OwnMotion own = inMetres(*from.file, {"", character.skeleton, {0.0}, rest});
  // Joints of the output do not shrink what hangs on them.
  const double metresPerUnit = character.skeleton.joint(0).rest.scale.x();
  std::vector<Affine3> jointFromModel;
  for (std::size_t j = 1; j < character.jointFromModel.size(); ++j) {
    jointFromModel.emplace_back(Eigen::Scaling(metresPerUnit) * character.jointFromModel[j]);
  }
  return readDocument(character, from.file->look, own.motion.skeleton, jointFromModel);
}

CharacterDocument characterDocument(const Character& character) {
  return readDocument(character, {}, character.skeleton, character.jointFromModel);
}

}  // namespace lorica
