#include "skinning/clip_files/character_clip.h"

#include "geometry/files.h"
#include "skinning/clip_files/gltf_animation.h"
#include "skinning/clip_files/gltf_embedding.h"
#include "skinning/clip_files/gltf_skin.h"
#include "skinning/clip_files/own_motion.h"

#include <numeric>

namespace lorica {

namespace {

namespace fs = std::filesystem;

[[nodiscard]] Result<void> writeGlb(const fs::path& out, GltfWriter& writer) {
  LORICA_TRY(const std::string bytes, writer.glb(out.string()));
  return writeFileAtomically(out, bytes);
}

[[nodiscard]] Error about(const fs::path& out, const Error& error) {
  return {error.code, out.string() + ": " + error.message};
}

/// The whole character from what Lorica holds.
[[nodiscard]] Result<void> writeWhole(const fs::path& out, const Character& character, const Look& look,
                                      const SkeletalMotion& motion, std::span<const Affine3> jointFromModel) {
  GltfWriter writer;
  const JointIndex firstJoint = character.skeleton.jointCount() - motion.skeleton.jointCount();
  addCharacter(writer, character, look, motion.skeleton, jointFromModel, firstJoint);
  std::vector<int> nodes(motion.skeleton.joints().size());
  std::iota(nodes.begin(), nodes.end(), 0);
  if (Result<void> added = addAnimation(writer, motion, nodes); !added) return about(out, added.error());
  return writeGlb(out, writer);
}

/// The user's own file with one animation more.
[[nodiscard]] Result<std::vector<std::string>> writeAdded(const fs::path& out, const ClipCharacter& from,
                                                          const SkeletalMotion& motion) {
  LORICA_TRY(const std::string content, readFile(from.path));
  const NamedFiles files{from.path.has_parent_path() ? from.path.parent_path() : ".", from.paths};
  std::vector<std::string> notes;
  LORICA_TRY(GltfWriter writer, embedGltf(std::as_bytes(std::span(content)), from.path.string(), files, notes));
  const OwnMotion own = inFileUnits(*from.file, motion);
  if (Result<void> added = addAnimationToFile(writer, own.motion, own.nodeOfJoint); !added) {
    return about(out, added.error());
  }
  LORICA_TRY_DO(writeGlb(out, writer));
  return notes;
}

}  // namespace

Result<std::vector<std::string>> writeClip(const fs::path& out, const ClipCharacter& from,
                                           const SkeletalMotion& motion) {
  const std::string& format = from.file->format;
  if (format.starts_with("glTF") || format.starts_with("VRM")) return writeAdded(out, from, motion);
  const Character& character = from.file->character;
  const OwnMotion own = inMetres(*from.file, motion);
  // Joints of the output do not shrink what hangs on them.
  const double metresPerUnit = character.skeleton.joint(0).rest.scale.x();
  std::vector<Affine3> jointFromModel;
  for (std::size_t j = 1; j < character.jointFromModel.size(); ++j) {
    jointFromModel.emplace_back(Eigen::Scaling(metresPerUnit) * character.jointFromModel[j]);
  }
  LORICA_TRY_DO(writeWhole(out, character, from.file->look, own.motion, jointFromModel));
  return std::vector<std::string>();
}

Result<void> writeClip(const fs::path& out, const Character& character, const SkeletalMotion& motion) {
  return writeWhole(out, character, {}, motion, character.jointFromModel);
}

}  // namespace lorica
