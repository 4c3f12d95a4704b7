#pragma once

#include "skinning/import/character_file.h"

#include <nlohmann/json_fwd.hpp>

#include <vector>

namespace lorica::test {

/// The pose that a shot asks for, of Lorica's own skeleton.
///
/// `rotations` of a shot are VRM's normalised ones: in the rest pose every bone's axes are those of the world. `hips`
/// is a movement of the hips in the world [m]. Fails the test for a bone that the character lacks.
/// https://github.com/vrm-c/vrm-specification: VRMC_vrm_animation-1.0/how_to_transform_human_pose.md
[[nodiscard]] Pose poseOf(const Character& character, const nlohmann::json& shot);

[[nodiscard]] std::vector<Vec3> posedVertices(const Character& character, const Pose& pose);

}  // namespace lorica::test
