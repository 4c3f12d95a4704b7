#pragma once

#include "skinning/import/file_scene.h"
#include "skinning/import/gltf_accessor.h"

namespace lorica {

/// Adds the file's animations of nodes. Animated morph weights are skipped, with a note.
[[nodiscard]] Result<void> addGltfClips(const GltfDocument& document, GltfAccessors& accessors, FileScene& scene);

}  // namespace lorica
