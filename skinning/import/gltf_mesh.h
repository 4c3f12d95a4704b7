#pragma once

#include "skinning/import/file_scene.h"
#include "skinning/import/gltf_accessor.h"

namespace lorica {

/// Counts of what was skipped in a file's meshes, for one note each.
struct GltfMeshCounts {
  int pointsAndLines = 0;      ///< primitives
  int withoutPositions = 0;    ///< primitives
  int rigidOnSkin = 0;         ///< primitives without joints, of a node with a skin
  std::size_t degenerate = 0;  ///< triangles that use a vertex twice
  std::size_t leftOver = 0;    ///< indices that do not form a complete triangle
};

/// Adds a mesh as a node draws it, with its default morph weights applied.
/// @param mesh  index, not yet checked
/// @param node  in range; so is its skin, or -1
[[nodiscard]] Result<void> addGltfMesh(const GltfDocument& document, GltfAccessors& accessors, int mesh, int node,
                                       FileScene& scene, GltfMeshCounts& statistics);

}  // namespace lorica
