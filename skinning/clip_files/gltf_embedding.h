#pragma once

#include "geometry/named_file.h"
#include "skinning/clip_files/gltf_writer.h"
#include "skinning/import/character_file.h"

#include <span>
#include <string>
#include <vector>

namespace lorica {

/// A glTF, GLB or VRM file of somebody, complete and unchanged, with all its buffers and pictures in one buffer.
/// @param name    of the file, for messages
/// @param files  where its other files are
/// @param notes   a sentence for each picture that was not found and stays a reference
[[nodiscard]] Result<GltfWriter> embedGltf(std::span<const std::byte> bytes, const std::string& name,
                                           const NamedFiles& files, std::vector<std::string>& notes);

/// Adds a motion of the file's joints, see addAnimation(): what differs from the pose in which the file was saved. A
/// node that moves gets translation, rotation and scale instead of its matrix.
/// @param nodeOfJoint  as in CharacterFile
[[nodiscard]] Result<void> addAnimationToFile(GltfWriter& writer, const SkeletalMotion& motion,
                                              std::span<const int> nodeOfJoint);

}  // namespace lorica
