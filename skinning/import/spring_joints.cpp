#include "skinning/import/spring_joints.h"

namespace lorica {

std::vector<int> nodesOfSprings(const SpringBones& springs) {
  std::vector<int> nodes;
  for (const SpringChain& chain : springs.chains) {
    for (const SpringJoint& joint : chain.joints) nodes.push_back(joint.joint);
    if (chain.center != kNoJoint) nodes.push_back(chain.center);
  }
  for (const SpringCollider& collider : springs.colliders) nodes.push_back(collider.joint);
  for (const NodeConstraint& constraint : springs.constraints) {
    nodes.push_back(constraint.joint);
    nodes.push_back(constraint.source);
  }
  return nodes;
}

SpringBones withJoints(SpringBones springs, const std::function<JointIndex(int)>& jointOfNode) {
  for (SpringChain& chain : springs.chains) {
    for (SpringJoint& joint : chain.joints) joint.joint = jointOfNode(joint.joint);
    if (chain.center != kNoJoint) chain.center = jointOfNode(chain.center);
  }
  for (SpringCollider& collider : springs.colliders) collider.joint = jointOfNode(collider.joint);
  for (NodeConstraint& constraint : springs.constraints) {
    constraint.joint = jointOfNode(constraint.joint);
    constraint.source = jointOfNode(constraint.source);
  }
  return springs;
}

}  // namespace lorica
