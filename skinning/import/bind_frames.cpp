#include "skinning/import/bind_frames.h"

#include <Eigen/SVD>

#include <algorithm>
#include <numeric>

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

BindFrames findBindFrames(const FileScene& scene) {
  BindFrames frames;
  frames.order = parentsFirst(scene.nodes);
  std::vector<int> rank(scene.nodes.size());
  for (std::size_t i = 0; i < frames.order.size(); ++i) {
    rank[frames.order[i]] = i;
  }
  const auto position = [&](std::vector<Affine3>& fileFromNode, const std::vector<char>& given) {
    for (const int node : frames.order) {
      const std::size_t i = node;
      if (given[i] != 0) continue;
      const Affine3 local = invertibleLocal(scene.nodes[i]);
      const int parent = scene.nodes[i].parent;
      fileFromNode[i] = parent == -1 ? local : fileFromNode[parent] * local;
    }
  };
  std::vector<char> given(scene.nodes.size(), 0);
  frames.fileFromNode.assign(scene.nodes.size(), Affine3::Identity());
  position(frames.fileFromNode, given);

  frames.fileFromSkin.assign(scene.skins.size(), Affine3::Identity());
  for (std::size_t s = 0; s < scene.skins.size(); ++s) {
    const FileSkin& skin = scene.skins[s];
    // Bones that an earlier skin has positioned come first, then the topmost.
    std::vector<std::size_t> bones(skin.nodes.size());
    std::iota(bones.begin(), bones.end(), std::size_t{0});
    std::stable_sort(bones.begin(), bones.end(), [&](std::size_t a, std::size_t b) {
      const std::size_t nodeA = skin.nodes[a];
      const std::size_t nodeB = skin.nodes[b];
      return given[nodeA] != given[nodeB] ? given[nodeA] > given[nodeB] : rank[nodeA] < rank[nodeB];
    });
    for (const std::size_t bone : bones) {
      const Affine3 fileFromSkin = frames.fileFromNode[skin.nodes[bone]] * skin.jointFromMesh[bone];
      if (!isInvertible(fileFromSkin)) continue;
      frames.fileFromSkin[s] = fileFromSkin;
      break;
    }
    for (const std::size_t bone : bones) {
      const std::size_t node = skin.nodes[bone];
      if (given[node] != 0 || !isInvertible(skin.jointFromMesh[bone])) continue;
      const Affine3 fileFromNode = frames.fileFromSkin[s] * skin.jointFromMesh[bone].inverse();
      if (!isInvertible(fileFromNode)) continue;
      frames.fileFromNode[node] = fileFromNode;
      given[node] = 1;
    }
  }
  position(frames.fileFromNode, given);
  return frames;
}

}  // namespace lorica
