#pragma once

#include "skinning/import/file_scene.h"
#include "skinning/import/gltf_document.h"

namespace lorica {

/// Adds the file's materials, and the pictures of those that meshes use, still encoded. A material or picture that is
/// broken becomes plain, with a note; all pictures together may have twice the bytes of the file, since they may share
/// them. Materials that no mesh uses have only a name.
///
/// glTF 2.0 with KHR_texture_transform, KHR_materials_unlit and KHR_materials_emissive_strength
/// (https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Khronos), and MToon 0.x and 1.0.
void addGltfMaterials(const GltfDocument& document, FileScene& scene);

}  // namespace lorica
