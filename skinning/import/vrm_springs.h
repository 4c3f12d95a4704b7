#pragma once

#include "skinning/import/file_scene.h"
#include "skinning/import/gltf_document.h"

namespace lorica {

/// Reads spring bones, their colliders and node constraints: `secondaryAnimation` of VRM 0.x, VRMC_springBone 1.0 with
/// VRMC_springBone_extended_collider, and VRMC_node_constraint 1.0. What refers to nodes, colliders or groups that do
/// not exist, repeats a node or exceeds the limits of spring_bones.h is skipped; there is one note for each kind of
/// fault. Sources: docs/SPRINGS.md.
/// @param scene  its nodes are read; springs and notes are written
void readVrmSprings(const GltfDocument& document, FileScene& scene);

}  // namespace lorica
