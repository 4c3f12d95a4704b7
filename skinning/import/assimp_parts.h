#pragma once

#include "geometry/named_file.h"
#include "skinning/import/file_scene.h"

#include <assimp/scene.h>

#include <cstdint>
#include <map>
#include <string>
#include <utility>

struct aiAnimation;
struct aiMesh;

namespace lorica {

/// A text of assimp's.
[[nodiscard]] std::string textOf(const aiString& text);

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

/// Adds the morph targets of assimp's meshes to a scene. The meshes of one node, one for each material, share targets
/// of the same name. Their weights begin at 0: what assimp 5.2 says about that is unreliable.
class AssimpMorphs {
 public:
  explicit AssimpMorphs(FileScene& scene) : scene_(scene) {}

  /// @param mesh  made from the other one, with the same vertices
  void add(const aiMesh& from, FileMesh& mesh);
  /// Adds the weights that an animation sets, after all meshes. assimp keeps the keys, not the curves between them.
  /// @param nodeOfName  index of the first node of each name
  void addWeights(const aiAnimation& from, double secondsPerTick, const std::map<std::string, int>& nodeOfName,
                  FileClip& clip);
  /// Adds the expressions, and notes for what was skipped. Called once, after all meshes and clips.
  void finish();

 private:
  FileScene& scene_;
  std::map<std::pair<int, std::string>, int> known_;  // by node and name
  std::map<std::pair<int, unsigned>, int> byIndex_;   // by node and position in a mesh; kAmbiguous
  std::uint64_t broken_ = 0;
  std::uint64_t lostWeights_ = 0;
  std::uint64_t beyondLimit_ = 0;
};

}  // namespace lorica
