#pragma once

#include "skinning/springs/spring_bones.h"

#include <functional>
#include <vector>

namespace lorica {

/// The nodes that swing, that tails collide with, that are centres, or that constraints read or turn. Ends of strands
/// are not among them: a tail is stored with its joint.
/// @param springs  with nodes instead of joints, see FileScene
[[nodiscard]] std::vector<int> nodesOfSprings(const SpringBones& springs);

/// Replaces nodes by their joints. All lengths stay in their joints' frames, which keep the file's numbers.
[[nodiscard]] SpringBones withJoints(SpringBones springs, const std::function<JointIndex(int)>& jointOfNode);

}  // namespace lorica
