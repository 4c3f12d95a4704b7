#pragma once

#include "skinning/import/file_scene.h"
#include "skinning/import/gltf_accessor.h"

namespace lorica {

/// Adds the morph targets of the scene's meshes, and the animation channels that move their weights.
///
/// A face is worth less than the body that carries it: a target or channel that is broken is skipped, with a note. All
/// targets together move no more vertices than the limit of GltfAccessors lets them.
/// @param scene  its meshes and clips are complete; element i of its clips is animation i
void addGltfMorphs(const GltfDocument& document, GltfAccessors& accessors, FileScene& scene);

}  // namespace lorica
