#pragma once

#include "skinning/springs/spring_simulation.h"

#include <string>
#include <vector>

namespace lorica::test {

/// A root and a strand of joints below it, each `length` from its parent along +X.
inline Skeleton strandSkeleton(int joints, double length = 0.1) {
  std::vector<Joint> all(static_cast<std::size_t>(joints) + 1);
  all[0].name = "root";
  for (std::size_t j = 1; j < all.size(); ++j) {
    all[j].name = "joint " + std::to_string(j);
    all[j].parent = static_cast<JointIndex>(j) - 1;
    if (j > 1) all[j].rest.translation = Vec3(length, 0.0, 0.0);
  }
  return Skeleton::create(all).value();
}

/// All joints of the strand swing in one chain.
inline SpringBones strandSprings(int joints, const SpringJoint& like, double length = 0.1) {
  SpringChain chain;
  chain.name = "strand";
  for (int j = 1; j <= joints; ++j) {
    SpringJoint joint = like;
    joint.joint = j;
    joint.tail = Vec3(length, 0.0, 0.0);
    chain.joints.push_back(joint);
  }
  SpringBones springs;
  springs.chains.push_back(chain);
  return springs;
}

inline SpringSimulation simulationOf(const Skeleton& skeleton, const SpringBones& springs) {
  return SpringSimulation::create(skeleton, springs).value();
}

/// World transforms of the joints in a pose.
inline std::vector<Affine3> worldOf(const Skeleton& skeleton, const Pose& pose) {
  std::vector<Affine3> world(pose.size());
  computeWorldFromJoint(skeleton, pose, world);
  return world;
}

}  // namespace lorica::test
