#pragma once

#include "skinning/import/file_scene.h"
#include "skinning/import/gltf_accessor.h"

namespace lorica {

/// Adds the file's animations of nodes, one clip each. Those of morph weights are added by addGltfMorphs().
[[nodiscard]] Result<void> addGltfClips(const GltfDocument& document, GltfAccessors& accessors, FileScene& scene);

}  // namespace lorica
