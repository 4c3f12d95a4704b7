#pragma once

#include "skinning/import/file_scene.h"
#include "skinning/import/gltf_accessor.h"

namespace lorica {

/// What was left out of a file's meshes, for one sentence each.
struct GltfMeshTally {
  int pointsAndLines = 0;      ///< primitives
  int withoutPositions = 0;    ///< primitives
  int rigidOnSkin = 0;         ///< primitives of a node with a skin that have no joints
  std::size_t degenerate = 0;  ///< triangles that name a vertex twice
  std::size_t leftOver = 0;    ///< indices that make no whole triangle
};

/// Adds a mesh as a node draws it: its triangles in the shape of its default morph weights.
/// @param mesh  index, not yet checked
/// @param node  in range; so is its skin, or -1
[[nodiscard]] Result<void> addGltfMesh(const GltfDocument& document, GltfAccessors& accessors, int mesh, int node,
                                       FileScene& scene, GltfMeshTally& tally);

}  // namespace lorica
