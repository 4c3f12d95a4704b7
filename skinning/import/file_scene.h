#pragma once

#include "geometry/tri_mesh.h"
#include "skinning/import/character_file.h"
#include "skinning/skeleton.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lorica {

/// A node as its file gives it, in the file's units.
struct FileNode {
  std::string name;
  int parent = -1;
  JointTransform local;  ///< parentFromNode at rest
  /// The turn that comes before `local` where a matrix shears, which translation, rotation and scale alone cannot say:
  /// parentFromNode = local * inner.
  std::optional<Quat> inner;

  [[nodiscard]] Affine3 parentFromNode() const {
    return inner ? Affine3(local.matrix() * *inner) : Affine3(local.matrix());
  }
};

/// Splits a matrix into what a node holds; exact for every finite matrix, by a singular value decomposition where it
/// shears.
void setMatrix(FileNode& node, const Affine3& parentFromNode);

/// Bones and their inverse bind matrices, as glTF's skin.
struct FileSkin {
  std::string name;
  std::vector<int> nodes;
  std::vector<Affine3> jointFromMesh;  ///< one a node
};

struct FileWeight {
  std::int64_t bone = 0;  ///< index into FileSkin::nodes; may be out of range
  double weight = 0.0;    ///< may be anything
};

/// Triangles that hang on one node, or on a skin's bones.
struct FileMesh {
  std::string name;
  int node = -1;
  int skin = -1;                         ///< -1: rigid on `node`
  std::vector<Vec3> positions;           ///< finite
  std::vector<Triangle> triangles;       ///< indices in range
  std::vector<FileWeight> weights;       ///< of vertex v: weightBegin[v] .. weightBegin[v + 1]; none where rigid
  std::vector<std::size_t> weightBegin;  ///< vertexCount + 1 entries; none where rigid
};

struct FileTrack {
  int node = -1;
  std::optional<KeyTrack<Vec3>> translation;
  std::optional<KeyTrack<Quat>> rotation;
  std::optional<KeyTrack<Vec3>> scale;
};

struct FileClip {
  std::string name;
  std::vector<FileTrack> tracks;
};

/// What a character file of any format says, checked but not yet brought to Lorica's units, axes and joints.
struct FileScene {
  std::string format;
  std::vector<FileNode> nodes;  ///< in any order; parents in range, no cycles
  std::vector<FileSkin> skins;
  std::vector<FileMesh> meshes;
  std::vector<FileClip> clips;
  std::vector<std::pair<HumanBone, int>> bones;  ///< the file's own list of humanoid bones and their nodes
  std::optional<double> metresPerUnit;           ///< where the file says it
  Quat modelFromFileAxes = Quat::Identity();

  int meshCount = 0;
  int primitiveCount = 0;
  int morphTargetCount = 0;
  std::vector<std::string> notes;
};

/// Builds skeleton, bind pose, weights and clips of what a file says.
/// @param fileName  for the sentences
[[nodiscard]] Result<CharacterFile> makeCharacterFile(const FileScene& scene, const std::string& fileName);

/// 1234567 as "1,234,567".
[[nodiscard]] std::string grouped(std::uint64_t number);

/// "mesh 3 'Body'", or "mesh 3" where it has no name.
[[nodiscard]] std::string titled(const char* kind, std::size_t index, const std::string& name);

}  // namespace lorica
