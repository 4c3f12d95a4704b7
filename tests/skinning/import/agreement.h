#pragma once

#include "skinning/import/character_file.h"
#include "tests/skinning/import/gltf_truth.h"

namespace lorica::test {

/// The largest distance of the character's skinned corners from the truth's [m]; corners 1 and 2 of a mirrored triangle
/// may be swapped. Different triangle counts fail the test.
/// @param clip  index into file.clips and the truth's animations; -1: at rest
[[nodiscard]] double farthestFromTruth(const CharacterFile& file, const GltfTruth& truth, int clip, double time);

/// The skinned mesh at a time of a clip; -1: at rest.
[[nodiscard]] std::vector<Vec3> posedVertices(const CharacterFile& file, int clip, double time);

}  // namespace lorica::test
