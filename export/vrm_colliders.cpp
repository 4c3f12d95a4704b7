#include "export/vrm_colliders.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "geometry/counts.h"
#include "geometry/errors.h"

namespace lorica {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kMaxBalls = 12;  // of a capsule

/// A capsule in the frame of a node.
struct NodeCapsule {
  int node = 0;
  Capsule capsule;
};

/// Joints that swing, or hang on one that does.
std::vector<bool> swingingJoints(const Skeleton& skeleton, const SpringBones& springs) {
  std::vector<bool> swings(skeleton.joints().size(), false);
  for (const SpringChain& chain : springs.chains) {
    for (const SpringJoint& joint : chain.joints) swings[joint.joint] = true;
  }
  for (std::size_t j = 0; j < swings.size(); ++j) {
    const JointIndex parent = skeleton.joints()[j].parent;
    if (parent != kNoJoint && swings[parent]) swings[j] = true;
  }
  return swings;
}

std::vector<NodeCapsule> capsulesOnNodes(const CharacterDocument& document, std::span<const RigidCollider> colliders,
                                         const std::vector<bool>& swings) {
  std::vector<NodeCapsule> capsules;
  for (const RigidCollider& collider : colliders) {
    const int node = document.hangOn[collider.joint];
    if (node < 0 || swings[collider.joint]) continue;
    const Affine3& nodeFromModel = document.nodeFromModel[collider.joint];
    const Capsule capsule = withVolume(collider.capsule, std::min(collider.volume, collider.capsule.volume()));
    const double scale = std::cbrt(std::abs(nodeFromModel.linear().determinant()));
    capsules.push_back({node, {nodeFromModel * capsule.from, nodeFromModel * capsule.to, scale * capsule.radius}});
  }
  return capsules;
}

/// VRMC_springBone 1.0: a group of spheres and capsules, used by every spring.
int addToVrm1(Json& springBone, std::span<const NodeCapsule> capsules) {
  Json group;
  group["name"] = "Lorica";
  for (const auto& [node, capsule] : capsules) {
    const bool ball = (capsule.to - capsule.from).norm() < 1e-3 * capsule.radius;
    Json collider;
    collider["node"] = node;
    Json& shape = collider["shape"][ball ? "sphere" : "capsule"];
    shape["offset"] = listOf(capsule.from);
    shape["radius"] = capsule.radius;
    if (!ball) shape["tail"] = listOf(capsule.to);
    group["colliders"].push_back(springBone["colliders"].size());
    springBone["colliders"].push_back(std::move(collider));
  }
  const std::size_t index = springBone["colliderGroups"].size();
  springBone["colliderGroups"].push_back(std::move(group));
  for (Json& spring : springBone["springs"]) spring["colliderGroups"].push_back(index);
  return countOf(capsules);
}

/// VRM 0.x: balls by node, used by every group of bones. Offsets are left-handed: z is negated.
int addToVrm0(Json& animation, std::span<const NodeCapsule> capsules) {
  int added = 0;
  const std::size_t first = animation["colliderGroups"].size();
  for (const auto& [node, capsule] : capsules) {
    const double length = (capsule.to - capsule.from).norm();
    const int balls = std::clamp(1 + static_cast<int>(std::ceil(length / capsule.radius)), 1, kMaxBalls);
    Json group;
    group["node"] = node;
    for (int b = 0; b < balls; ++b) {
      const double t = balls == 1 ? 0.5 : static_cast<double>(b) / (balls - 1);
      const Vec3 center = (1.0 - t) * capsule.from + t * capsule.to;
      Json ball;
      ball["offset"]["x"] = center.x();
      ball["offset"]["y"] = center.y();
      ball["offset"]["z"] = -center.z();
      ball["radius"] = capsule.radius;
      group["colliders"].push_back(std::move(ball));
      ++added;
    }
    animation["colliderGroups"].push_back(std::move(group));
  }
  for (Json& bones : animation["boneGroups"]) {
    for (std::size_t g = first; g < animation["colliderGroups"].size(); ++g) bones["colliderGroups"].push_back(g);
  }
  return added;
}

}  // namespace

Result<int> addSpringColliders(CharacterDocument& document, std::span<const RigidCollider> colliders,
                               const Skeleton& skeleton, const SpringBones& springs, const std::string& name) {
  Json& all = document.writer.document;
  Json none = Json::object();
  Json& extensions = all.contains("extensions") ? all["extensions"] : none;
  const bool vrm1 = extensions.contains("VRMC_vrm");
  if (!vrm1 && !extensions.contains("VRM")) {
    return unsupported("{}: no VRM, so a .vrm cannot be made of it; expected OUT.glb", name);
  }
  if (springs.chains.empty()) {
    return unsupported("{}: has no springs that colliders could touch; expected OUT.glb", name);
  }
  const std::vector<NodeCapsule> capsules = capsulesOnNodes(document, colliders, swingingJoints(skeleton, springs));
  if (vrm1) return addToVrm1(extensions["VRMC_springBone"], capsules);
  return addToVrm0(extensions["VRM"]["secondaryAnimation"], capsules);
}

}  // namespace lorica
