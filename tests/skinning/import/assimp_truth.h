#pragma once

#include "geometry/math.h"

#include <assimp/scene.h>

#include <map>
#include <string>
#include <vector>

namespace lorica::test {

/// Transforms of assimp's nodes with linear keys, computed by 4x4 matrices without any code of import/. In the file's
/// units and axes.
/// @param animation  -1: at rest
[[nodiscard]] std::map<std::string, Mat4> assimpNodes(const aiScene& scene, int animation, double seconds);

/// The corners of all triangles, skinned as assimp defines it: the sum of weight * node * offset * vertex, divided by
/// the sum of the weights. Nodes in assimp's order, their meshes, their faces.
[[nodiscard]] std::vector<Vec3> assimpCorners(const aiScene& scene, int animation, double seconds);

}  // namespace lorica::test
