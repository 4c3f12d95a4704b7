#pragma once

#include "geometry/text.h"
#include "geometry/tri_mesh.h"
#include "skinning/import/character_file.h"
#include "skinning/look/look.h"
#include "skinning/skeleton.h"
#include "skinning/springs/spring_bones.h"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lorica {

/// A node of a file, in the file's units.
struct FileNode {
  std::string name;
  int parent = -1;
  JointTransform local;  ///< parentFromNode at rest
  /// The rotation applied before `local` if a matrix has shear, which translation, rotation and scale alone cannot
  /// represent: parentFromNode = local * inner.
  std::optional<Quat> inner;

  [[nodiscard]] Affine3 parentFromNode() const {
    return inner ? Affine3(local.matrix() * *inner) : Affine3(local.matrix());
  }
};

/// Decomposes a matrix into the members of a node; exact for every finite matrix, by a singular value decomposition if
/// it has shear.
void setMatrix(FileNode& node, const Affine3& parentFromNode);

/// Bones and their inverse bind matrices, like a glTF skin.
struct FileSkin {
  std::string name;
  std::vector<int> nodes;
  std::vector<Affine3> jointFromMesh;  ///< one per node
};

struct FileWeight {
  std::int64_t bone = 0;  ///< index into FileSkin::nodes; may be out of range
  double weight = 0.0;    ///< any value
};

/// What a morph target does to the vertices of one mesh.
struct FileMorph {
  int target = 0;                    ///< index into FileScene::morphTargets
  std::vector<MorphOffset> offsets;  ///< in the mesh's units; vertices ascend
};

/// Triangles attached to one node, or to a skin's bones.
struct FileMesh {
  std::string name;
  int node = -1;
  int skin = -1;                         ///< -1: rigid on `node`
  std::vector<Vec3> positions;           ///< finite
  std::vector<Triangle> triangles;       ///< indices in range
  std::vector<FileWeight> weights;       ///< of vertex v: weightBegin[v] .. weightBegin[v + 1]; empty if rigid
  std::vector<std::size_t> weightBegin;  ///< vertexCount + 1 entries; empty if rigid
  std::vector<FileMorph> morphs;
  int primitive = -1;                       ///< of the file's mesh, if it has morph targets
  std::vector<VertexIndex> sourceVertices;  ///< index of each vertex in the primitive, if it has morph targets
  // How it looks: one element for each vertex, or empty.
  std::vector<Vec3f> normals;  ///< empty: flat triangles; any length, finite
  std::vector<Eigen::Vector4f> tangents;
  std::vector<Eigen::Vector2f> uv[2];
  std::vector<Eigen::Vector4f> colors;  ///< linear RGBA
  int material = -1;                    ///< index into FileScene::materials; -1 = none
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
  std::vector<MorphWeightTrack> weights;  ///< targets are indices into FileScene::morphTargets
};

/// A morph target of a node's mesh, which its primitives share.
struct FileMorphTarget {
  std::string name;
  int node = -1;
  int mesh = -1;   ///< the file's index
  int index = -1;  ///< among the targets of that mesh
  float defaultWeight = 0.0F;
};

/// The content of a character file of any format, checked but not yet converted to Lorica's units, axes and joints.
struct FileScene {
  std::string format;
  std::vector<FileNode> nodes;  ///< in any order; parents in range, no cycles
  std::vector<FileSkin> skins;
  std::vector<FileMesh> meshes;
  std::vector<FileClip> clips;
  std::vector<std::pair<HumanBone, int>> bones;  ///< the file's own list of humanoid bones and their nodes
  std::vector<FileMorphTarget> morphTargets;
  Expressions expressions;  ///< of morphTargets
  LookAt lookAt;            ///< without its joints
  int leftEye = -1;         ///< node, or -1
  int rightEye = -1;        ///< node, or -1
  std::vector<Material> materials;
  std::vector<StoredPicture> pictures;
  /// Indices of nodes instead of joints, and lengths in the file's units; directions have Lorica's axes.
  SpringBones springs;
  std::optional<double> metresPerUnit;  ///< if the file specifies it
  Quat modelFromFileAxes = Quat::Identity();

  int meshCount = 0;
  int primitiveCount = 0;
  int morphTargetCount = 0;
  std::vector<std::string> notes;

  /// Adds the note "1,234 faces are points", unless the count is 0. @param one  "face is a point"
  void note(std::uint64_t count, std::string_view one, std::string_view many);
};

/// For each node whether it, or one below it, is a bone, carries a rigid mesh or swings; all nodes of a scene with only
/// motion.
[[nodiscard]] std::vector<char> movingNodes(const FileScene& scene);

/// Refuses a scene beyond these limits. @param fileName  for messages
[[nodiscard]] Result<void> checkWork(const FileScene& scene, const std::string& fileName);

/// Builds skeleton, bind pose, weights and clips from a file's content.
/// @param fileName  for messages
[[nodiscard]] Result<CharacterFile> makeCharacterFile(FileScene scene, const std::string& fileName,
                                                      const CharacterFileSettings& settings = {});

/// What a material uses of a mesh's vertices, beside normals.
struct LookNeeds {
  std::array<bool, 2> uv = {false, false};
  bool tangents = false;
  bool colors = true;  ///< MToon ignores them
};

[[nodiscard]] LookNeeds needsOf(const Material& material);

/// Notes of the same kind become one sentence if there are many.
class CountedNotes {
 public:
  /// @param kind      what follows a count: "pictures are not available"
  /// @param sentence  of this one alone
  void add(const std::string& kind, std::string sentence);
  /// Appends up to four sentences a kind, or one that counts them and gives the first as an example.
  void appendTo(std::vector<std::string>& notes) const;

 private:
  struct Kind {
    std::string name;
    std::uint64_t count = 0;
    std::vector<std::string> sentences;
  };
  std::vector<Kind> kinds_;
};

/// "mesh 3 'Body'", or "mesh 3" if it has no name.
[[nodiscard]] std::string titled(const char* kind, std::size_t index, const std::string& name);

/// The nodes that swing, that tails collide with, that are centres, or that constraints read or turn. Ends of strands
/// are not among them: a tail is stored with its joint.
/// @param springs  with nodes instead of joints, see FileScene
[[nodiscard]] std::vector<int> nodesOfSprings(const SpringBones& springs);

/// Replaces nodes by their joints. All lengths stay in their joints' frames, which keep the file's numbers.
[[nodiscard]] SpringBones withJoints(SpringBones springs, const std::function<JointIndex(int)>& jointOfNode);

struct UnitGuess {
  double metresPerUnit = 1.0;
  std::string note;  ///< one sentence if the unit was guessed, else empty
};

/// Guesses the length of a file's unit from the size of its character in the bind pose.
///
/// glTF specifies metres, but many files contain centimetres, or were scaled by an extra factor. Between 2 cm and 55 m
/// the size is what the format says, with a note above 10 m; outside, the unit is the one of 1 mm, 1 cm, 1 m, 100 m and
/// 1 km that brings the longest side nearest to 1.7 m, so that no guess leads away from a human. If the file specifies
/// its unit, sizes up to 100 m are accepted, since they may be intended.
/// @param longestSide   of the bind pose [units of the file]; 0 if unknown
/// @param saidByFile    unit specified by the file [m]
[[nodiscard]] UnitGuess guessUnit(double longestSide, std::optional<double> saidByFile);

}  // namespace lorica
