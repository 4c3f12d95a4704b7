#include "skinning/clip_files/character_clip.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "skinning/clip_files/character_document.h"
#include "skinning/clip_files/gltf_embedding.h"
#include "skinning/clip_files/own_motion.h"

#include <numeric>

namespace lorica {

namespace {

namespace fs = std::filesystem;

[[nodiscard]] Result<void> writeGlb(const fs::path& out, GltfWriter& writer) {
  LORICA_TRY(const std::string bytes, writer.glb(out.string()));
  return writeFileAtomically(out, bytes);
}

/// Adds a motion of all joints of a document that Lorica has made of a character, whose nodes have the same order.
[[nodiscard]] Result<void> addToMade(GltfWriter& writer, const SkeletalMotion& motion) {
  std::vector<int> nodes(motion.skeleton.joints().size());
  std::iota(nodes.begin(), nodes.end(), 0);
  return addAnimation(writer, motion, nodes);
}

}  // namespace

Result<std::vector<std::string>> writeClip(const fs::path& out, const ClipCharacter& from,
                                           const SkeletalMotion& motion) {
  LORICA_TRY(CharacterDocument document, characterDocument(from));
  if (isOfGltf(*from.file)) {
    const OwnMotion own = inFileUnits(*from.file, motion);
    LORICA_TRY_DO(prefixed(out.string(), addAnimationToFile(document.writer, own.motion, own.nodeOfJoint)));
  } else {
    LORICA_TRY_DO(prefixed(out.string(), addToMade(document.writer, inMetres(*from.file, motion).motion)));
  }
  LORICA_TRY_DO(writeGlb(out, document.writer));
  return std::move(document.notes);
}

Result<void> writeClip(const fs::path& out, const Character& character, const SkeletalMotion& motion) {
  CharacterDocument document = characterDocument(character);
  LORICA_TRY_DO(prefixed(out.string(), addToMade(document.writer, motion)));
  return writeGlb(out, document.writer);
}

}  // namespace lorica
