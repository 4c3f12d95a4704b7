#pragma once

#include "geometry/named_file.h"
#include "skinning/import/file_scene.h"

#include <assimp/scene.h>

#include <cstdint>

namespace lorica {

/// Adds an FBX or COLLADA scene's materials, and the pictures of those that meshes use, still encoded. What is not
/// available stays plain, with a note. No materials if the file has none beside assimp's default.
///
/// These formats describe Phong's model. A diffuse texture replaces the diffuse colour; colours are sRGB, as three.js
/// takes them (https://github.com/mrdoob/three.js/blob/dev/examples/jsm/loaders/FBXLoader.js); metallic is 0. With the
/// specular colour's largest channel s, 0 to 1, and the exponent n,
///     roughness = 1 - s (1 - (2 / (n + 2))^(1/4)),
/// where the last term is the roughness whose GGX highlight is as wide as Blinn's with that exponent: n = 2 / a^2 - 2,
/// a = roughness^2 (Walter et al. 2007, https://doi.org/10.2312/EGWR/EGSR07/195-206).
///
/// A texture's transform is a scale, then a rotation about the picture's middle, then a translation, with v up.
/// @param files  where pictures are searched; an empty folder: other files are not read
void addAssimpMaterials(const aiScene& from, const NamedFiles& files, FileScene& scene);

/// Adds how a mesh looks: its material, normals, and what the material needs. Numbers that are not finite become 0 and
/// are counted.
void addAssimpLook(const aiMesh& from, const FileScene& scene, FileMesh& mesh, std::uint64_t& notFinite);

}  // namespace lorica
