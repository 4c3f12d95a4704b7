#pragma once

#include "skinning/import/file_scene.h"

#include <map>
#include <string>
#include <utility>

struct aiAnimation;
struct aiMesh;

namespace lorica {

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
