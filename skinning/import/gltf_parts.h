#pragma once

#include "skinning/import/file_scene.h"
#include "skinning/import/gltf_accessor.h"
#include "skinning/import/gltf_document.h"

// What is read of a glTF file, part by part, once its nodes are known.

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

/// Adds the file's materials, and the pictures of those that meshes use, still encoded. A material or picture that is
/// broken becomes plain, with a note; all pictures together may have twice the bytes of the file, since they may share
/// them. Materials that no mesh uses have only a name.
///
/// glTF 2.0 with KHR_texture_transform, KHR_materials_unlit and KHR_materials_emissive_strength
/// (https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Khronos), and MToon 0.x and 1.0.
void addGltfMaterials(const GltfDocument& document, FileScene& scene);

/// Adds the morph targets of the scene's meshes, and the animation channels that move their weights.
///
/// A face is worth less than the body that carries it: a target or channel that is broken is skipped, with a note. All
/// targets together move no more vertices than the limit of GltfAccessors lets them.
/// @param scene  its meshes and clips are complete; element i of its clips is animation i
void addGltfMorphs(const GltfDocument& document, GltfAccessors& accessors, FileScene& scene);

/// Reads spring bones, their colliders and node constraints: `secondaryAnimation` of VRM 0.x, VRMC_springBone 1.0 with
/// VRMC_springBone_extended_collider, and VRMC_node_constraint 1.0. What refers to nodes, colliders or groups that do
/// not exist, repeats a node or exceeds the limits of spring_bones.h is skipped; there is one note for each kind of
/// fault. Sources: docs/SPRINGS.md.
/// @param scene  its nodes are read; springs and notes are written
void readVrmSprings(const GltfDocument& document, FileScene& scene);

}  // namespace lorica
