#pragma once

#include "skinning/import/character_file.h"
#include "tests/skinning/import/gltf_truth.h"

namespace lorica::test {

/// How far the character's skinned corners lie from the truth's, at most [m]; corners 1 and 2 of a mirrored triangle
/// may be swapped. Counts of triangles that differ fail the test.
/// @param clip  index into file.clips and the truth's animations; -1: at rest
[[nodiscard]] double farthestFromTruth(const CharacterFile& file, const GltfTruth& truth, int clip, double time);

/// The skinned mesh at a moment of a clip; -1: at rest.
[[nodiscard]] std::vector<Vec3> posedVertices(const CharacterFile& file, int clip, double time);

}  // namespace lorica::test
