#include "skinning/import/character_parts.h"

#include "geometry/counts.h"
#include "geometry/work_budgets.h"
#include "skinning/humanoid/humanoid_names.h"
#include "skinning/import/bind_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace lorica {

namespace {

constexpr int kFewestFlat = 8;  ///< children of one node; no body has so many

/// The nodes as joints at the positions of the bind pose, and the node of each.
struct NodeSkeleton {
  std::vector<int> nodes;
  std::vector<JointIndex> jointOfNode;
  Skeleton skeleton;
};

[[nodiscard]] std::optional<NodeSkeleton> skeletonOf(const FileScene& scene, const BindFrames& frames) {
  NodeSkeleton made{frames.order, std::vector<JointIndex>(scene.nodes.size(), kNoJoint), {}};
  std::vector<Joint> joints;
  for (const int node : frames.order) {
    made.jointOfNode[node] = countOf(joints);
    const int parent = scene.nodes[node].parent;
    const Vec3 from = parent == -1 ? Vec3::Zero() : Vec3(frames.fileFromNode[parent].translation());
    Joint joint{scene.nodes[node].name, parent == -1 ? kNoJoint : made.jointOfNode[parent], {}, std::nullopt};
    joint.rest.translation = frames.fileFromNode[node].translation() - from;
    joints.push_back(std::move(joint));
  }
  for (const auto& [bone, node] : scene.bones) joints[made.jointOfNode[node]].bone = bone;
  Result<Skeleton> skeleton = Skeleton::create(std::move(joints));
  if (!skeleton) return std::nullopt;
  made.skeleton = std::move(*skeleton);
  return made;
}

/// The bones of skins that are children of one node and most of all bones, with that node if it is a bone too.
[[nodiscard]] std::vector<int> flatBonesOf(const FileScene& scene) {
  std::vector<char> isBone(scene.nodes.size(), 0);
  for (const FileSkin& skin : scene.skins) {
    for (const int node : skin.nodes) isBone[node] = 1;
  }
  std::map<int, std::vector<int>> bonesBelow;
  for (std::size_t n = 0; n < isBone.size(); ++n) {
    if (isBone[n] != 0) bonesBelow[scene.nodes[n].parent].push_back(n);
  }
  const auto count = std::count(isBone.begin(), isBone.end(), 1);
  for (auto& [parent, bones] : bonesBelow) {
    if (countOf(bones) < kFewestFlat || 2 * countOf(bones) <= count) continue;
    if (parent != -1 && isBone[parent] != 0) bones.push_back(parent);
    return bones;
  }
  return {};
}

}  // namespace

void hangFlatBones(FileScene& scene) {
  // A motion written into a glTF file has the hierarchy of that file.
  if (scene.format != "FBX" && scene.format != "COLLADA") return;
  const std::vector<int> bones = flatBonesOf(scene);
  if (bones.empty()) return;
  for (const FileClip& clip : scene.clips) {  // their keys are relative to the parents that the file has
    for (const FileTrack& track : clip.tracks) {
      if (std::find(bones.begin(), bones.end(), track.node) != bones.end()) return;
    }
  }
  const BindFrames frames = findBindFrames(scene);
  const std::optional<NodeSkeleton> nodes = skeletonOf(scene, frames);
  if (!nodes) return;
  std::vector<JointIndex> flat;
  flat.reserve(bones.size());
  for (const int node : bones) flat.push_back(nodes->jointOfNode[node]);
  const std::vector<JointIndex> parents =
      parentsByNames(JointTree(nodes->skeleton), readJointNames(nodes->skeleton), flat);
  if (parents.empty()) return;

  std::vector<Affine3> fileFromNode(scene.nodes.size());
  for (const int node : frames.order) {
    const int parent = scene.nodes[node].parent;
    fileFromNode[node] = parent == -1 ? scene.nodes[node].parentFromNode()
                                      : Affine3(fileFromNode[parent] * scene.nodes[node].parentFromNode());
  }
  std::vector<int> changed(scene.nodes.size(), -1);
  for (std::size_t i = 0; i < bones.size(); ++i) {
    if (parents[i] != kNoJoint) changed[bones[i]] = nodes->nodes[parents[i]];
  }
  // A parent that is below its child, or cannot be inverted, would make the file worse.
  for (std::size_t i = 0; i < bones.size(); ++i) {
    std::size_t steps = 0;
    for (int node = bones[i]; node != -1; ++steps) {
      if (steps > scene.nodes.size() || !isInvertible(fileFromNode[node])) return;
      node = changed[node] != -1 ? changed[node] : scene.nodes[node].parent;
    }
  }
  int count = 0;
  for (std::size_t node = 0; node < changed.size(); ++node) {
    if (changed[node] == -1 || changed[node] == scene.nodes[node].parent) continue;
    scene.nodes[node].parent = changed[node];
    setMatrix(scene.nodes[node], fileFromNode[changed[node]].inverse() * fileFromNode[node]);
    ++count;
  }
  scene.notes.push_back(
      fmt::format("its bones are a list without a hierarchy: the parents of {} were found by their "
                  "names",
                  count));
}

bool lacksBones(const FileScene& scene) {
  if (scene.bones.empty()) return true;
  using enum HumanBone;
  constexpr std::array kNeeded = {kHips,          kSpine,         kHead,          kLeftUpperLeg, kRightUpperLeg,
                                  kLeftLowerLeg,  kRightLowerLeg, kLeftFoot,      kRightFoot,    kLeftUpperArm,
                                  kRightUpperArm, kLeftLowerArm,  kRightLowerArm, kLeftHand,     kRightHand};
  return scene.format != "VRM animation 1.0" && std::ranges::any_of(kNeeded, [&](HumanBone needed) {
           return std::ranges::none_of(scene.bones, [&](const auto& bone) { return bone.first == needed; });
         });
}

void addRigidSkin(FileScene& scene) {
  if (!scene.skins.empty() || !scene.clips.empty() || scene.nodes.size() > kMaxJoints) return;
  FileSkin skin{"(nodes)", {}, {}};
  for (const auto& [bone, node] : scene.bones) skin.nodes.push_back(node);
  const BindFrames frames = findBindFrames(scene);
  if (lacksBones(scene)) {
    const std::optional<NodeSkeleton> nodes = skeletonOf(scene, frames);
    const HumanoidGuess guess = nodes ? guessHumanoid(nodes->skeleton) : HumanoidGuess();
    if (guess.by.starts_with("names")) {
      skin.nodes.clear();  // the guess has them too
      for (const JointIndex joint : guess.jointOf) {
        if (joint != kNoJoint) skin.nodes.push_back(nodes->nodes[joint]);
      }
    }
  }
  // A figure in one piece on one of its bones stays a mesh.
  std::vector<int> boneOf(scene.nodes.size(), -1);  // itself or the nearest above
  for (const int bone : skin.nodes) boneOf[bone] = bone;
  for (const int node : frames.order) {
    const int parent = scene.nodes[node].parent;
    if (boneOf[node] == -1 && parent != -1) boneOf[node] = boneOf[parent];
  }
  std::vector<char> carries(scene.nodes.size(), 0);
  for (const FileMesh& mesh : scene.meshes) {
    if (boneOf[mesh.node] != -1) carries[boneOf[mesh.node]] = 1;
  }
  const auto carriers = std::count(carries.begin(), carries.end(), 1);
  if (carriers < 2 || skin.nodes.empty()) return;
  for (const int node : skin.nodes) skin.jointFromMesh.push_back(frames.fileFromNode[node].inverse());
  scene.notes.push_back(
      fmt::format("has no skin: its {} meshes follow {} humanoid bones, rigidly", scene.meshes.size(), carriers));
  scene.skins.push_back(std::move(skin));
}

}  // namespace lorica
