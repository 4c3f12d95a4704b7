#pragma once

#include "skinning/import/character_file.h"
#include "tests/skinning/import/gltf_truth.h"

namespace lorica::test {

/// The largest distance of the character's skinned corners from the truth's [m]; corners 1 and 2 of a mirrored triangle
/// may be swapped. Different triangle counts fail the test.
/// @param clip  index into file.clips and the truth's animations; -1: as saved
[[nodiscard]] double farthestFromTruth(const CharacterFile& file, const GltfTruth& truth, int clip, double time);

/// The pose of a glTF file's nodes, which need not be the rest pose.
[[nodiscard]] Pose savedPose(const CharacterFile& file, const nlohmann::json& nodes);

/// The skinned mesh in a pose, or at a time of a clip; -1: at rest.
[[nodiscard]] std::vector<Vec3> posedVertices(const CharacterFile& file, const Pose& pose);
[[nodiscard]] std::vector<Vec3> posedVertices(const CharacterFile& file, int clip, double time);

}  // namespace lorica::test
