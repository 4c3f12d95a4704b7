#include "skinning/springs/spring_simulation.h"
#include "tests/skinning/springs/strand.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lorica::test {
namespace {

/// One joint, computed step by step with 4 x 4 matrices as the section "SpringBone Algorithm" of VRMC_springBone 1.0
/// writes it, without shortcuts.
class SpecJoint {
 public:
  SpecJoint(const Mat4& parentWorld, const Mat4& initialLocal, const Quat& initialRotation, const Vec3& childPosition)
      : initialLocal_(initialLocal), initialRotation_(initialRotation), boneAxis_(childPosition.normalized()) {
    const Mat4 world = parentWorld * initialLocal;
    current_ = previous_ = apply(world, childPosition);
    boneLength_ = (apply(world, childPosition) - apply(world, Vec3::Zero())).norm();
    rotation_ = initialRotation;
  }

  void update(const Mat4& parentWorld, const Quat& parentWorldRotation, const SpringJoint& settings, double deltaTime,
              const Vec3& sphere, double sphereRadius) {
    const Vec3 inertia = (current_ - previous_) * (1.0 - settings.dragForce);
    const Vec3 stiffness = deltaTime * (parentWorldRotation * (initialRotation_ * boneAxis_)) * settings.stiffness;
    const Vec3 external = deltaTime * settings.gravityDir * settings.gravityPower;
    Vec3 next = current_ + inertia + stiffness + external;
    const Vec3 worldPosition = apply(parentWorld * initialLocal_, Vec3::Zero());
    next = worldPosition + (next - worldPosition).normalized() * boneLength_;
    const Vec3 delta = next - sphere;
    const double distance = delta.norm() - sphereRadius - settings.hitRadius;
    if (distance < 0.0) {
      next -= delta.normalized() * distance;
      next = worldPosition + (next - worldPosition).normalized() * boneLength_;
    }
    previous_ = current_;
    current_ = next;
    const Vec3 to = apply((parentWorld * initialLocal_).inverse(), next).normalized();
    rotation_ = initialRotation_ * Quat::FromTwoVectors(boneAxis_, to);
  }

  [[nodiscard]] const Quat& rotation() const { return rotation_; }

 private:
  [[nodiscard]] static Vec3 apply(const Mat4& matrix, const Vec3& p) { return (matrix * p.homogeneous()).head<3>(); }
  Mat4 initialLocal_;
  Quat initialRotation_;
  Vec3 boneAxis_, current_, previous_;
  double boneLength_ = 0.0;
  Quat rotation_;
};

TEST(SpringSimulation, FollowsTheSpecificationStepByStep) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto vector = [&](double size) {
    return Vec3(size * normal(random), size * normal(random), size * normal(random));
  };
  const auto turn = [&] { return Quat(normal(random), normal(random), normal(random), normal(random)).normalized(); };
  // A moving root, then joints 1 to 3 with random rest rotations; joint 4 is the end of the chain.
  std::vector<Joint> joints(5);
  for (std::size_t j = 1; j < joints.size(); ++j) {
    joints[j].parent = static_cast<JointIndex>(j) - 1;
    joints[j].rest.translation = vector(0.1);
    joints[j].rest.rotation = turn();
  }
  const Skeleton skeleton = Skeleton::create(joints).value();
  SpringBones bones;
  bones.chains.emplace_back();
  for (int j = 1; j <= 3; ++j) {
    bones.chains[0].joints.push_back({.joint = j,
                                      .tail = joints[j + 1].rest.translation,
                                      .stiffness = 0.5 * j,
                                      .gravityPower = 0.3,
                                      .gravityDir = vector(1.0),
                                      .dragForce = 0.2 * j,
                                      .hitRadius = 0.02});
  }
  bones.colliders.push_back({.joint = 0, .offset = Vec3(0.1, 0.0, 0.1), .radius = 0.12});
  bones.colliderGroups.push_back({0});
  bones.chains[0].colliderGroups = {0};
  SpringSimulation springs = simulationOf(skeleton, bones);

  std::vector<SpecJoint> truth;
  for (int frame = 0; frame < 120; ++frame) {
    Pose pose = restPose(skeleton);
    pose[0].translation = Vec3(0.3 * std::sin(0.1 * frame), 0.05 * std::sin(0.3 * frame), 0.02 * frame);
    pose[0].rotation = Quat(Eigen::AngleAxisd(0.7 * std::sin(0.13 * frame), Vec3(1.0, 2.0, 3.0).normalized()));
    Mat4 parentWorld = pose[0].matrix().matrix();
    Quat parentRotation = pose[0].rotation;
    const Vec3 sphere = pose[0].matrix() * bones.colliders[0].offset;
    springs.advance(pose, kSpringStepSeconds);
    for (int j = 1; j <= 3; ++j) {
      const JointTransform& rest = joints[j].rest;
      const Mat4 initial = rest.matrix().matrix();
      if (frame == 0) {
        truth.emplace_back(parentWorld, initial, rest.rotation, joints[j + 1].rest.translation);
      } else {
        truth[j - 1].update(parentWorld, parentRotation, bones.chains[0].joints[j - 1], kSpringStepSeconds, sphere,
                            bones.colliders[0].radius);
      }
      ASSERT_LT(pose[j].rotation.angularDistance(truth[j - 1].rotation()), 1e-7) << "frame " << frame << " joint " << j;
      JointTransform local = rest;
      local.rotation = truth[j - 1].rotation();
      parentWorld = parentWorld * local.matrix().matrix();
      parentRotation = parentRotation * local.rotation;
    }
  }
}

}  // namespace
}  // namespace lorica::test
