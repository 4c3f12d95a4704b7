#pragma once

#include "skinning/skeleton.h"

#include <random>

namespace lorica::test {

inline double uniform(std::mt19937& random, double low, double high) {
  // Not std::uniform_real_distribution: its numbers differ between standard libraries.
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

inline Vec3 randomVector(std::mt19937& random, double size) {
  const double x = uniform(random, -size, size);
  const double y = uniform(random, -size, size);
  const double z = uniform(random, -size, size);
  return {x, y, z};
}

inline Quat randomRotation(std::mt19937& random) {
  for (;;) {
    Eigen::Vector4d q;
    for (int i = 0; i < 4; ++i) q[i] = uniform(random, -1.0, 1.0);
    if (q.norm() > 0.1) return Quat(q.normalized());
  }
}

/// A random rotation and translation for every joint; with a random scale if requested.
inline Pose randomPose(const Skeleton& skeleton, std::mt19937& random, bool scaled) {
  Pose pose = restPose(skeleton);
  for (JointTransform& joint : pose) {
    joint.rotation = randomRotation(random);
    joint.translation += randomVector(random, 0.1);
    if (scaled) joint.scale = Vec3::Ones() + randomVector(random, 0.5);
  }
  return pose;
}

/// A transform's matrix from first principles: the quaternion's formula, the columns scaled.
inline Mat4 matrixByHand(const JointTransform& t) {
  const double w = t.rotation.w();
  const double x = t.rotation.x();
  const double y = t.rotation.y();
  const double z = t.rotation.z();
  Mat4 m = Mat4::Identity();
  m.topLeftCorner<3, 3>() << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
      2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),                         //
      2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
  for (int c = 0; c < 3; ++c) m.block<3, 1>(0, c) *= t.scale[c];
  m.block<3, 1>(0, 3) = t.translation;
  return m;
}

/// One joint's world matrix, multiplied from the joint up to its root.
inline Mat4 worldFromJointByHand(const Skeleton& skeleton, std::span<const JointTransform> pose, JointIndex joint) {
  Mat4 product = Mat4::Identity();
  for (JointIndex j = joint; j != kNoJoint; j = skeleton.joint(j).parent) {
    product = (matrixByHand(pose[j]) * product).eval();
  }
  return product;
}

}  // namespace lorica::test
