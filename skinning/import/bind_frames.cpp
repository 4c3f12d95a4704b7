#include "skinning/import/bind_frames.h"

#include "geometry/counts.h"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

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

/// The rotation of a node, of a sheared one the nearest.
[[nodiscard]] Quat turnOf(const FileNode& node) {
  return (node.inner ? node.local.rotation * *node.inner : node.local.rotation).normalized();
}

/// The scale of a transform that keeps shapes, to within a hundredth; 0 of another one.
[[nodiscard]] double scaleIfSimilar(const Affine3& transform) {
  if (!transform.matrix().allFinite()) return 0.0;
  const Vec3 stretch = Eigen::JacobiSVD<Mat3>(transform.linear()).singularValues();
  return stretch.x() <= 1.01 * stretch.z() ? stretch.y() : 0.0;
}

/// By how much lengths grow, in the mean of all directions.
[[nodiscard]] double scaleOf(const Affine3& transform) {
  return std::cbrt(std::abs(transform.linear().determinant()));
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
    frames_.inner.reserve(nodeCount);
    frames_.scaledByMatrix.assign(nodeCount, 0);
    for (const FileNode& node : scene_.nodes) {
      frames_.local.push_back(node.local);
      frames_.inner.push_back(node.inner);
    }
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

  /// The smallest and the largest scale that most bones give a skin. If no two give the same, that of its mesh's node.
  [[nodiscard]] std::pair<double, double> usualScales(std::size_t s) const {
    std::vector<double> scales;
    for (std::size_t bone = 0; bone < skins_[s].says.size(); ++bone) {
      if (skins_[s].says[bone] == 0) continue;
      if (const double scale = scaleIfSimilar(fileFromSkinBy(s, bone)); scale > 0.0) scales.push_back(scale);
    }
    std::sort(scales.begin(), scales.end());
    std::size_t first = 0, most = 1;
    std::pair<double, double> usual{0.0, kInfinity};
    for (std::size_t last = 0; last < scales.size(); ++last) {
      while (scales[last] > (1.0 + kSameScale) * scales[first]) ++first;
      if (last - first + 1 <= most) continue;
      most = last - first + 1;
      usual = {scales[first], scales[last]};
    }
    if (most > 1 || scales.size() < 2 || skins_[s].meshNode == -1) return usual;
    const double byMesh = scaleOf(frames_.fileFromNode[skins_[s].meshNode]);
    return {byMesh / (1.0 + kSameScale), byMesh * (1.0 + kSameScale)};
  }

  /// Where a skin stands, by a bone of the usual scale; else by one that at least leaves its mesh about as large as the
  /// mesh's node does; else as that node does.
  [[nodiscard]] Affine3 spaceOfSkin(std::size_t s, std::span<const std::size_t> bones) const {
    const FileSkin& skin = scene_.skins[s];
    const bool strict = frames_.posed && skins_[s].meshNode != -1;
    const std::pair<double, double> usual = strict ? usualScales(s) : std::pair(0.0, kInfinity);
    const double byMesh = strict ? scaleOf(frames_.fileFromNode[skins_[s].meshNode]) : 0.0;
    for (const bool loose : {false, true}) {
      for (const std::size_t bone : bones) {
        const Affine3 fileFromSkin = fileFromSkinBy(s, bone);
        if ((frames_.posed && skins_[s].says[bone] == 0) || !isInvertible(fileFromSkin)) continue;
        const double similar = scaleIfSimilar(fileFromSkin), ratio = scaleOf(fileFromSkin) / byMesh;
        const bool trusted = !strict || (loose ? ratio > 0.5 && ratio < 2.0
                                               : similar > 0.0 && similar >= usual.first && similar <= usual.second);
        if (!trusted) continue;
        const bool known = !frames_.posed || given_[skin.nodes[bone]] != 0;
        return known ? fileFromSkin : spaceOfPosed(s, bone, fileFromSkin);
      }
    }
    const Affine3 none = Affine3::Identity();
    const Affine3& ofMesh = strict ? frames_.fileFromNode[skins_[s].meshNode] : none;
    return isInvertible(ofMesh) ? ofMesh : none;
  }

  /// Among bones that give a skin one scale, those whose matrices would make it more than twice as large.
  void findScaledByMatrix(std::size_t s) {
    const FileSkin& skin = scene_.skins[s];
    const auto [low, high] = usualScales(s);
    int usual = 0;
    double ofMatrix = 0.0;
    for (std::size_t bone = 0; bone < skin.nodes.size(); ++bone) {
      const double scale = skins_[s].says[bone] != 0 ? scaleIfSimilar(fileFromSkinBy(s, bone)) : 0.0;
      if (!(scale > 0.0 && scale >= low && scale <= high)) continue;
      ++usual;
      ofMatrix = std::max(ofMatrix, scaleOf(skin.jointFromMesh[bone]));
    }
    if (usual < 2 || !(high < kInfinity)) return;
    for (std::size_t bone = 0; bone < skin.nodes.size(); ++bone) {
      if (skins_[s].says[bone] == 0 || given_[skin.nodes[bone]] != 0) continue;
      const bool larger = scaleOf(fileFromSkinBy(s, bone)) > 2.0 * high;
      if (larger && scaleOf(skin.jointFromMesh[bone]) > 2.0 * ofMatrix) frames_.scaledByMatrix[skin.nodes[bone]] = 1;
    }
  }

  void placeSkin(std::size_t s) {
    const FileSkin& skin = scene_.skins[s];
    const auto isGiven = [&](int node) { return given_[node] != 0; };
    // Hair and clothes with bones of their own hang on the bones that an earlier skin has moved.
    if (frames_.posed && std::none_of(skin.nodes.begin(), skin.nodes.end(), isGiven)) placeOthers();
    const std::vector<std::size_t> bones = bonesOf(s);
    const auto says = [&](std::size_t bone) { return !frames_.posed || skins_[s].says[bone] != 0; };
    frames_.fileFromSkin[s] = spaceOfSkin(s, bones);
    if (frames_.posed) findScaledByMatrix(s);
    for (const std::size_t bone : bones) {
      const std::size_t node = skin.nodes[bone];
      if (given_[node] != 0 || !says(bone) || !isInvertible(skin.jointFromMesh[bone])) continue;
      const Affine3 fileFromNode = frames_.fileFromSkin[s] * skin.jointFromMesh[bone].inverse();
      if (!isInvertible(fileFromNode)) continue;
      frames_.fileFromNode[node] = fileFromNode;
      given_[node] = 1;
    }
  }

  /// Replaces the nodes' transforms by those of the bind pose.
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
      if (given_[i] != 0 && wanted.matrix().allFinite()) {
        FileNode bind = node;
        const Affine3 saved = invertibleLocal(node);
        const double scale = std::cbrt(std::abs(wanted.linear().determinant()));
        const bool same = (wanted.linear() - saved.linear()).norm() <= kRounding * scale &&
                          (fileFromParent.linear() * (wanted.translation() - saved.translation())).norm() <=
                              kRounding * box.diagonal();
        if (!same) setMatrix(bind, wanted);
        const Quat rotation = turnOf(bind);
        for (const Vec3& scales : {node.local.scale, Vec3(wanted.linear().colwise().norm())}) {
          if (same || !bind.inner) break;  // a little shear is rounding
          const JointTransform plain{bind.local.translation, rotation, scales};
          if ((plain.matrix().linear() - wanted.linear()).norm() > kAgrees * scale) continue;
          bind.local = plain;
          bind.inner.reset();
        }
        const double turn = rotation.angularDistance(turnOf(node));
        const double move = (fileFromParent.linear() * (bind.local.translation - node.local.translation)).norm();
        if (turn > std::numbers::pi / 180.0 || move > 0.01 * box.diagonal()) {
          ++frames_.posedNodes;
          frames_.posedTurn = std::max(frames_.posedTurn, turn);
          frames_.posedMove = std::max(frames_.posedMove, move);
        }
        const Vec3 ratios = bind.local.scale.cwiseQuotient(node.local.scale);
        const bool sameScale = (ratios - Vec3::Ones()).cwiseAbs().maxCoeff() <= kSameScale;
        if (!sameScale || (bind.inner && !node.inner)) ++frames_.scaledNodes;
        if (node.inner && !bind.inner) bind.inner = Quat::Identity();
        frames_.local[i] = bind.local;
        frames_.inner[i] = bind.inner;
      }
      FileNode at = node;
      at.local = frames_.local[i];
      at.inner = frames_.inner[i];
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
