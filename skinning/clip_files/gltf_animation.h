#pragma once

#include "skinning/clip.h"
#include "skinning/clip_files/gltf_writer.h"

#include <span>

namespace lorica {

/// Adds a motion as the document's first animation: linear keys at the motion's frames, from time 0, of what differs
/// from the rest pose.
/// @param nodes  of each joint; -1: the joint is no node and must not move
/// @return or that a number is not finite, or that a joint without a node moves
[[nodiscard]] Result<void> addAnimation(GltfWriter& writer, const SkeletalMotion& motion, std::span<const int> nodes);

}  // namespace lorica
