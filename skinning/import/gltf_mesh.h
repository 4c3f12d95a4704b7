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
  std::size_t notFinite = 0;   ///< numbers of normals, tangents, texture coordinates and colours
};

/// What meshes are read with.
struct GltfMeshSources {
  const GltfDocument& document;
  GltfAccessors& accessors;
  /// For normals, tangents, texture coordinates and colours, which are left out, with a note, where they are broken or
  /// too many. They have a limit of their own, so that a file is not refused for them.
  GltfAccessors& lookAccessors;
};

/// Adds a mesh as a node draws it, with its default morph weights applied.
/// Of how it looks, only what its materials need is read, so scene.materials must be complete; nothing if there are no
/// materials.
/// @param mesh  index, not yet checked
/// @param node  in range; so is its skin, or -1
[[nodiscard]] Result<void> addGltfMesh(const GltfMeshSources& sources, int mesh, int node, FileScene& scene,
                                       GltfMeshCounts& statistics, CountedNotes& notes);

}  // namespace lorica
