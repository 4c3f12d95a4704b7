#pragma once

#include "skinning/import/file_scene.h"

#include <map>
#include <string>
#include <utility>

struct aiMesh;

namespace lorica {

/// Adds the morph targets of assimp's meshes to a scene. The meshes of one node, one for each material, share targets
/// of the same name. Their weights begin at 0 and no clip moves them: what assimp 5.2 says about either is unreliable.
class AssimpMorphs {
 public:
  explicit AssimpMorphs(FileScene& scene) : scene_(scene) {}

  /// @param mesh  made from the other one, with the same vertices
  void add(const aiMesh& from, FileMesh& mesh);
  /// Adds the expressions, and a note for targets that were skipped. Called once, after all meshes.
  void finish();

 private:
  FileScene& scene_;
  std::map<std::pair<int, std::string>, int> known_;  // by node and name
  std::uint64_t broken_ = 0;
  std::uint64_t beyondLimit_ = 0;
};

}  // namespace lorica
