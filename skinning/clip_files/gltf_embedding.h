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

/// Adds a motion as the document's first animation: linear keys at the motion's frames, from time 0, of what differs
/// from the rest pose.
/// @param nodes  of each joint; -1: the joint is no node and must not move
/// @return or that a number is not finite, or that a joint without a node moves
[[nodiscard]] Result<void> addAnimation(GltfWriter& writer, const SkeletalMotion& motion, std::span<const int> nodes);

/// Adds a motion of the file's joints, see addAnimation(): what differs from the pose in which the file was saved. A
/// node that moves gets translation, rotation and scale instead of its matrix.
/// @param nodeOfJoint  as in CharacterFile
[[nodiscard]] Result<void> addAnimationToFile(GltfWriter& writer, const SkeletalMotion& motion,
                                              std::span<const int> nodeOfJoint);

}  // namespace lorica
