#include "skinning/import/bind_frames.h"

#include "geometry/counts.h"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

namespace lorica {

namespace {

/// Nodes in the file's order, each after its parent.
[[nodiscard]] std::vector<int> parentsFirst(const std::vector<FileNode>& nodes) {
  std::vector<std::vector<int>> children(nodes.size());
  std::vector<int> stack;
  for (std::size_t i = nodes.size(); i-- > 0;) {
    const int parent = nodes[i].parent;
    (parent == -1 ? stack : children[parent]).push_back(i);
  }
  std::vector<int> order;
  order.reserve(nodes.size());
  while (!stack.empty()) {
    const int node = stack.back();
    stack.pop_back();
    order.push_back(node);
    const std::vector<int>& below = children[node];
    stack.insert(stack.end(), below.begin(), below.end());
  }
  LORICA_CHECK(order.size() == nodes.size(), "the reader rejects cycles");
  return order;
}

/// A node's rest transform; without its scale if that makes it singular.
[[nodiscard]] Affine3 invertibleLocal(const FileNode& node) {
  const Affine3 local = node.parentFromNode();
  if (isInvertible(local)) return local;
  FileNode unscaled = node;
  unscaled.local.scale = Vec3::Ones();
  return unscaled.parentFromNode();
}

}  // namespace

bool isInvertible(const Affine3& transform) {
  if (!transform.matrix().allFinite()) return false;
  const Vec3 stretch = Eigen::JacobiSVD<Mat3>(transform.linear()).singularValues();
  return stretch.z() > 1e-8 * stretch.x();
}

namespace {

constexpr double kAgrees = 1e-3;     ///< of a skin's size: what moves its vertices less is rounding
constexpr double kRounding = 1e-6;   ///< below it, a node keeps its numbers
constexpr int kBodyBones = 5;        ///< of a body that a node may lay down
constexpr double kSameScale = 0.01;  ///< of a mesh's node and its bones, else the node's transform has no meaning

/// What the inverse bind matrices of one skin say.
struct SkinBind {
  Aabb box;  ///< of its vertices, in their space
  std::vector<const FileMesh*> meshes;
  int meshNode = -1;       ///< of the first mesh; -1: no mesh is drawn
  std::vector<char> says;  ///< per bone: its matrix is invertible, and moves vertices or is more than the identity
};

class BindFinder {
 public:
  explicit BindFinder(const FileScene& scene) : scene_(scene) {}

  [[nodiscard]] BindFrames find() {
    const std::size_t nodeCount = scene_.nodes.size();
    frames_.order = parentsFirst(scene_.nodes);
    rank_.resize(nodeCount);
    for (std::size_t i = 0; i < frames_.order.size(); ++i) rank_[frames_.order[i]] = i;
    given_.assign(nodeCount, 0);
    frames_.fileFromNode.assign(nodeCount, Affine3::Identity());
    frames_.fileFromSkin.assign(scene_.skins.size(), Affine3::Identity());
    frames_.local.reserve(nodeCount);
    for (const FileNode& node : scene_.nodes) frames_.local.push_back(node.local);
    placeOthers();

    readSkins();
    std::vector<std::size_t> skins(scene_.skins.size());
    std::iota(skins.begin(), skins.end(), std::size_t{0});
    frames_.posed = std::any_of(skins.begin(), skins.end(), [&](std::size_t s) { return isPosed(s); });
    if (frames_.posed) {  // the largest skin stands most likely, and the others follow it
      std::stable_sort(skins.begin(), skins.end(), [&](std::size_t a, std::size_t b) {
        return scene_.skins[a].nodes.size() > scene_.skins[b].nodes.size();
      });
    }
    for (const std::size_t s : skins) placeSkin(s);
    placeOthers();
    if (frames_.posed) turnNodes();
    return std::move(frames_);
  }

 private:
  /// Nodes that no skin has positioned follow their parents.
  void placeOthers() {
    for (const int i : frames_.order) {
      if (given_[i] != 0) continue;
      const Affine3 local = invertibleLocal(scene_.nodes[i]);
      const int parent = scene_.nodes[i].parent;
      frames_.fileFromNode[i] = parent == -1 ? local : frames_.fileFromNode[parent] * local;
    }
  }

  void readSkins() {
    skins_.resize(scene_.skins.size());
    for (std::size_t s = 0; s < skins_.size(); ++s) skins_[s].says.assign(scene_.skins[s].nodes.size(), 0);
    for (const FileMesh& mesh : scene_.meshes) {
      if (mesh.skin == -1) continue;
      SkinBind& skin = skins_[mesh.skin];
      if (skin.meshNode == -1) skin.meshNode = mesh.node;
      skin.meshes.push_back(&mesh);
      for (const Vec3& p : mesh.positions) skin.box.extend(p);
      for (const FileWeight& w : mesh.weights) {
        if (w.bone >= 0 && w.bone < countOf(skin.says) && w.weight > 0.0) skin.says[w.bone] = 1;
      }
    }
    for (std::size_t s = 0; s < skins_.size(); ++s) {
      const std::vector<Affine3>& matrices = scene_.skins[s].jointFromMesh;
      for (std::size_t b = 0; b < matrices.size(); ++b) {
        const bool unset = skins_[s].says[b] == 0 && matrices[b].isApprox(Affine3::Identity(), 1e-9);
        skins_[s].says[b] = !unset && isInvertible(matrices[b]) ? 1 : 0;
      }
    }
  }

  [[nodiscard]] Affine3 fileFromSkinBy(std::size_t s, std::size_t bone) const {
    return frames_.fileFromNode[scene_.skins[s].nodes[bone]] * scene_.skins[s].jointFromMesh[bone];
  }

  /// Whether two transforms of a skin's vertices are the same but for rounding.
  [[nodiscard]] bool agree(std::size_t s, const Affine3& a, const Affine3& b) const {
    const Aabb& box = skins_[s].box;
    const double size = box.empty() ? 1.0 : std::max(box.diagonal(), box.center().norm());
    const Vec3 center = box.empty() ? Vec3::Zero() : box.center();
    const double scale = std::cbrt(std::abs(a.linear().determinant()));
    return (a.linear() - b.linear()).norm() <= kAgrees * scale &&
           (a * center - b * center).norm() <= kAgrees * scale * size;
  }

  /// Bones that an earlier skin has positioned come first, then the topmost.
  [[nodiscard]] std::vector<std::size_t> bonesOf(std::size_t s) const {
    const FileSkin& skin = scene_.skins[s];
    std::vector<std::size_t> bones(skin.nodes.size());
    std::iota(bones.begin(), bones.end(), std::size_t{0});
    std::stable_sort(bones.begin(), bones.end(), [&](std::size_t a, std::size_t b) {
      const std::size_t nodeA = skin.nodes[a];
      const std::size_t nodeB = skin.nodes[b];
      return given_[nodeA] != given_[nodeB] ? given_[nodeA] > given_[nodeB] : rank_[nodeA] < rank_[nodeB];
    });
    return bones;
  }

  /// Whether the nodes contradict the matrices. Matrices that are all the same say nothing about a pose: each bone has
  /// its vertices in its own space.
  [[nodiscard]] bool isPosed(std::size_t s) const {
    const std::vector<Affine3>& matrices = scene_.skins[s].jointFromMesh;
    if (skins_[s].meshNode == -1) return false;
    if (std::all_of(matrices.begin(), matrices.end(),
                    [&](const Affine3& m) { return m.isApprox(matrices[0], 1e-9); })) {
      return false;
    }
    std::optional<Affine3> first;
    for (const std::size_t bone : bonesOf(s)) {
      if (skins_[s].says[bone] == 0) continue;
      const Affine3 fileFromSkin = fileFromSkinBy(s, bone);
      if (!isInvertible(fileFromSkin)) continue;
      if (!first) first = fileFromSkin;
      if (!agree(s, *first, fileFromSkin)) return true;
    }
    return first && standsByMeshAlone(s, *first);
  }

  /// The space of the node with the skin's mesh; none if it cannot be that of the vertices.
  [[nodiscard]] std::optional<Affine3> spaceOfMesh(std::size_t s, const Affine3& byBone) const {
    if (skins_[s].meshNode == -1) return std::nullopt;
    const Affine3& byMesh = frames_.fileFromNode[skins_[s].meshNode];
    const double ratio = byMesh.linear().determinant() / byBone.linear().determinant();
    if (!(std::abs(std::cbrt(ratio) - 1.0) < kSameScale)) return std::nullopt;
    return byMesh;
  }

  /// Whether a node lays down the whole body, and not a part such as a sword: what lies by its bones and stands by its
  /// mesh was modelled standing.
  [[nodiscard]] bool standsByMeshAlone(std::size_t s, const Affine3& byBone) const {
    if (std::count(skins_[s].says.begin(), skins_[s].says.end(), 1) < kBodyBones) return false;
    const std::optional<Affine3> byMesh = spaceOfMesh(s, byBone);
    return byMesh && !agree(s, byBone, *byMesh) && uprightness(s, byBone) < 0.5 && uprightness(s, *byMesh) > 0.7;
  }

  /// The height of a skin's meshes by their longest side.
  [[nodiscard]] double uprightness(std::size_t s, const Affine3& fileFromSkin) const {
    Aabb box;
    for (const FileMesh* mesh : skins_[s].meshes) {
      for (const Vec3& p : mesh->positions) box.extend(scene_.modelFromFileAxes * (fileFromSkin * p));
    }
    const Vec3 sides = box.max - box.min;
    return sides.y() / std::max(sides.maxCoeff(), 1e-300);
  }

  /// The space of a posed skin whose bones no other skin has positioned.
  /// @param byBone  what its topmost bone says
  [[nodiscard]] Affine3 spaceOfPosed(std::size_t s, std::size_t topmost, const Affine3& byBone) const {
    const std::optional<Affine3> byMesh = spaceOfMesh(s, byBone);
    if (!byMesh) return byBone;
    const auto supports = [&](std::size_t b) {
      return b != topmost && skins_[s].says[b] != 0 && agree(s, byBone, fileFromSkinBy(s, b));
    };
    std::size_t b = 0;
    while (b < skins_[s].says.size() && !supports(b)) ++b;
    const bool supported = b < skins_[s].says.size();
    const bool lies = uprightness(s, *byMesh) < 0.5 && uprightness(s, byBone) > 0.7;
    return supported ? (standsByMeshAlone(s, byBone) ? *byMesh : byBone) : (lies ? byBone : *byMesh);
  }

  void placeSkin(std::size_t s) {
    const FileSkin& skin = scene_.skins[s];
    const auto isGiven = [&](int node) { return given_[node] != 0; };
    // Hair and clothes with bones of their own hang on the bones that an earlier skin has moved.
    if (frames_.posed && std::none_of(skin.nodes.begin(), skin.nodes.end(), isGiven)) placeOthers();
    const std::vector<std::size_t> bones = bonesOf(s);
    const auto says = [&](std::size_t bone) { return !frames_.posed || skins_[s].says[bone] != 0; };
    for (const std::size_t bone : bones) {
      const Affine3 fileFromSkin = fileFromSkinBy(s, bone);
      if (!says(bone) || !isInvertible(fileFromSkin)) continue;
      const bool known = !frames_.posed || isGiven(skin.nodes[bone]);
      frames_.fileFromSkin[s] = known ? fileFromSkin : spaceOfPosed(s, bone, fileFromSkin);
      break;
    }
    for (const std::size_t bone : bones) {
      const std::size_t node = skin.nodes[bone];
      if (given_[node] != 0 || !says(bone) || !isInvertible(skin.jointFromMesh[bone])) continue;
      const Affine3 fileFromNode = frames_.fileFromSkin[s] * skin.jointFromMesh[bone].inverse();
      if (!isInvertible(fileFromNode)) continue;
      frames_.fileFromNode[node] = fileFromNode;
      given_[node] = 1;
    }
  }

  /// Replaces the nodes' transforms by those of the bind pose. What cannot be held without shear keeps its scale; its
  /// children are where they belong.
  void turnNodes() {
    Aabb box;
    for (std::size_t i = 0; i < given_.size(); ++i) {
      if (given_[i] != 0) box.extend(frames_.fileFromNode[i].translation());
    }
    std::vector<Affine3> fileFromNode(scene_.nodes.size());
    for (const int i : frames_.order) {
      const FileNode& node = scene_.nodes[i];
      const Affine3 fileFromParent = node.parent == -1 ? Affine3::Identity() : fileFromNode[node.parent];
      const Affine3 wanted = fileFromParent.inverse() * frames_.fileFromNode[i];
      if (given_[i] != 0 && !node.inner && wanted.matrix().allFinite()) {
        FileNode bind = node;
        const Affine3 saved = invertibleLocal(node);
        const double scale = std::cbrt(std::abs(wanted.linear().determinant()));
        const bool same = (wanted.linear() - saved.linear()).norm() <= kRounding * scale &&
                          (fileFromParent.linear() * (wanted.translation() - saved.translation())).norm() <=
                              kRounding * box.diagonal();
        if (!same) setMatrix(bind, wanted);
        if (bind.inner) {
          bind.local.rotation = (bind.local.rotation * *bind.inner).normalized();
          bind.local.scale = node.local.scale;
        }
        const double turn = bind.local.rotation.angularDistance(node.local.rotation);
        const double move = (fileFromParent.linear() * (bind.local.translation - node.local.translation)).norm();
        if (turn > std::numbers::pi / 180.0 || move > 0.01 * box.diagonal()) {
          ++frames_.posedNodes;
          frames_.posedTurn = std::max(frames_.posedTurn, turn);
          frames_.posedMove = std::max(frames_.posedMove, move);
        }
        frames_.local[i] = bind.local;
      }
      FileNode at = node;
      at.local = frames_.local[i];
      fileFromNode[i] = fileFromParent * invertibleLocal(at);
    }
  }

  const FileScene& scene_;
  BindFrames frames_;
  std::vector<SkinBind> skins_;
  std::vector<int> rank_;    // of each node in frames_.order
  std::vector<char> given_;  // per node: a skin has positioned it
};

}  // namespace

BindFrames findBindFrames(const FileScene& scene) {
  return BindFinder(scene).find();
}

}  // namespace lorica
