#include "skinning/springs/spring_bones.h"
#include "geometry/work_budgets.h"
#include "skinning/springs/spring_collider.h"
#include "skinning/springs/spring_simulation.h"
#include "tests/skinning/springs/strand.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace lorica::test {
namespace {

using Kind = NodeConstraint::Kind;

/// The sentence that refuses sound springs after a change; empty if they are accepted.
std::string refusal(const std::function<void(SpringBones&)>& change) {
  const Skeleton skeleton = strandSkeleton(4);
  SpringBones springs = strandSprings(3, {.stiffness = 1.0});
  springs.chains[0].joints.pop_back();
  springs.colliders.push_back({.joint = 0, .radius = 0.1});
  springs.colliderGroups.push_back({0});
  springs.chains[0].colliderGroups = {0};
  change(springs);
  const Result<SpringSimulation> made = SpringSimulation::create(skeleton, springs);
  return made ? "" : made.error().message;
}

TEST(SpringBones, SoundOnesAreAccepted) {
  EXPECT_EQ(refusal([](SpringBones&) {}), "");
}

TEST(SpringBones, BadOnesAreRefusedWithASentence) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::pair<std::function<void(SpringBones&)>, const char*> faults[] = {
      {[](SpringBones& s) { s.chains[0].joints[1].joint = 5; }, "chain 0, joint 1: joint 5 does not exist"},
      {[](SpringBones& s) { s.chains[0].joints[1].joint = kNoJoint; }, "joint -1 does not exist"},
      {[](SpringBones& s) { s.chains[0].joints[0].tail.setZero(); }, "its tail is at 0"},
      {[](SpringBones& s) { s.chains[0].joints[0].tail.x() = kNan; }, "its tail is at 0 or not finite"},
      {[](SpringBones& s) { s.chains[0].joints[0].stiffness = -1.0; }, "stiffness -1"},
      {[](SpringBones& s) { s.chains[0].joints[0].dragForce = 1.5; }, "drag 1.5"},
      {[](SpringBones& s) { s.chains[0].joints[0].gravityDir.x() = kInfinity; }, "expected finite numbers"},
      {[](SpringBones& s) { s.chains.push_back(s.chains[0]); }, "chain 1, joint 0: swings in chain 0 already"},
      {[](SpringBones& s) { s.chains[0].joints.clear(); }, "chain 0: has no joints"},
      {[](SpringBones& s) { s.chains[0].center = 2; }, "its centre, joint 2, swings with it"},
      {[](SpringBones& s) { s.chains[0].center = 9; }, "joint 9 does not exist"},
      {[](SpringBones& s) { s.chains[0].colliderGroups = {1}; }, "collider group 1 does not exist"},
      {[](SpringBones& s) { s.colliderGroups[0] = {-1}; }, "collider -1 does not exist"},
      {[](SpringBones& s) { s.colliders[0].joint = 77; }, "collider 0: joint 77 does not exist"},
      {[](SpringBones& s) { s.colliders[0].radius = kNan; }, "collider 0: radius nan"},
      {[](SpringBones& s) { s.constraints.push_back({.joint = 4, .source = 12}); }, "joint 12 does not exist"},
      {[](SpringBones& s) { s.constraints.push_back({.joint = 4, .source = 1, .weight = 2.0}); }, "weight 2"},
      {[](SpringBones& s) { s.constraints = {{.joint = 4, .source = 4}}; }, "joint 4 depends on itself"},
      {[](SpringBones& s) { s.constraints.assign(2, {.joint = 4, .source = 1}); }, "joint 4 has another"},
      {[](SpringBones& s) { s.constraints.assign(kMaxNodeConstraints + 1, {}); }, "1001 constraints"},
      {[](SpringBones& s) { s.colliders.resize(kMaxSpringColliders + 1); }, "10001 colliders"},
      {[](SpringBones& s) {
         s.colliderGroups[0].assign(1000, 0);
         s.chains[0].colliderGroups.assign(1000, 0);
       },
       "2000000 pairs"},
  };
  for (const auto& [change, words] : faults) {
    const std::string sentence = refusal(change);
    EXPECT_NE(sentence.find(words), std::string::npos) << "expected: " << words << "\nfound: " << sentence;
  }
}

TEST(SpringBones, AsMuchAsTheBudgetsIsTaken) {
  EXPECT_EQ(refusal([](SpringBones& s) { s.colliders.resize(kMaxSpringColliders, s.colliders[0]); }), "");
  const std::size_t groups = kMaxSpringPairs / 1000 / 2;  // for each of two joints
  for (const std::size_t more : {0U, 1U}) {
    const std::string sentence = refusal([&](SpringBones& s) {
      s.colliderGroups[0].assign(1000, 0);
      s.chains[0].colliderGroups.assign(groups + more, 0);
    });
    EXPECT_EQ(sentence.find("pairs") != std::string::npos, more > 0) << sentence;
  }
}

TEST(SpringBones, AsManyJointsAsTheBudgetsSwingAndFollow) {
  const Skeleton skeleton = strandSkeleton(static_cast<int>(kMaxSprings) + 1);
  for (const bool follow : {false, true}) {
    for (const std::size_t more : {0U, 1U}) {
      SpringBones springs = follow ? SpringBones() : strandSprings(static_cast<int>(kMaxSprings + more), {});
      for (std::size_t j = 1; follow && j <= kMaxNodeConstraints + more; ++j) {
        springs.constraints.push_back({.joint = static_cast<JointIndex>(j), .source = 0});
      }
      const Result<void> checked = checkSprings(skeleton, springs);
      EXPECT_EQ(checked.ok(), more == 0) << (checked ? "" : checked.error().message);
    }
  }
}

TEST(SpringBones, ACentreMayBeTheFirstJoint) {
  EXPECT_EQ(refusal([](SpringBones& s) { s.chains[0].center = 1; }), "");
}

Affine3 somewhere() {
  return Eigen::Translation3d(0.4, -0.2, 1.0) * Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -1.0).normalized()) *
         Eigen::Scaling(1.5);
}

/// Distance to a segment by trying many of its points.
double distanceToSegment(const Vec3& a, const Vec3& b, const Vec3& p) {
  double least = kInfinity;
  for (int i = 0; i <= 20000; ++i) least = std::min(least, (a + (b - a) * (i / 20000.0) - p).norm());
  return least;
}

TEST(SpringCollider, BallsAreMovedToTheSurface) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Affine3 world = somewhere();
  const auto point = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
  int hits = 0;
  for (int i = 0; i < 300; ++i) {
    for (const SpringColliderShape shape : {SpringColliderShape::kSphere, SpringColliderShape::kCapsule,
                                            SpringColliderShape::kInsideSphere, SpringColliderShape::kInsideCapsule}) {
      const SpringCollider collider{.shape = shape, .offset = 0.3 * point(), .tail = 0.3 * point(), .radius = 0.6};
      const Vec3 center = world * point();
      const auto hit = hitCollider(collider, world, center, 0.1);
      const bool round = shape == SpringColliderShape::kSphere || shape == SpringColliderShape::kInsideSphere;
      const bool inside = shape == SpringColliderShape::kInsideSphere || shape == SpringColliderShape::kInsideCapsule;
      const Vec3 begin = world * collider.offset;
      const Vec3 end = round ? begin : Vec3(world * collider.tail);
      const double distance = distanceToSegment(begin, end, center);
      const double depth = inside ? distance - (0.6 - 0.1) : 0.6 + 0.1 - distance;
      ASSERT_EQ(hit.has_value(), depth > 0.0);
      if (!hit) continue;
      ++hits;
      EXPECT_NEAR(hit->depth, depth, 1e-6);
      EXPECT_NEAR(hit->direction.norm(), 1.0, 1e-12);
      const double after = distanceToSegment(begin, end, center + hit->depth * hit->direction);
      EXPECT_NEAR(after, inside ? 0.5 : 0.7, 1e-6);
    }
  }
  EXPECT_GT(hits, 100);
}

TEST(SpringCollider, APlaneKeepsBallsOnItsSide) {
  Affine3 world = somewhere();
  world.linear() = world.linear() * Vec3(1.0, 3.0, 0.5).asDiagonal();
  const Vec3 normal = Vec3(1.0, 1.0, 1.0).normalized();
  const SpringCollider plane{.shape = SpringColliderShape::kPlane, .offset = Vec3(0.1, 0.2, 0.3), .normal = normal};
  // Two directions within the plane, moved by the matrix, span the plane in the world.
  const Vec3 u = world.linear() * normal.unitOrthogonal();
  const Vec3 v = world.linear() * normal.cross(normal.unitOrthogonal());
  Vec3 worldNormal = u.cross(v).normalized();
  if (worldNormal.dot(world.linear() * normal) < 0.0) worldNormal = -worldNormal;
  const Vec3 on = world * plane.offset;
  EXPECT_FALSE(hitCollider(plane, world, on + 0.11 * worldNormal + 2.0 * u, 0.1));
  const auto hit = hitCollider(plane, world, on - 0.3 * worldNormal + 2.0 * u, 0.1);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->depth, 0.4, 1e-12);
  EXPECT_NEAR((hit->direction - worldNormal).norm(), 0.0, 1e-12);
}

TEST(SpringCollider, TheCentreOfASphereHasNoWayOut) {
  EXPECT_FALSE(hitCollider({.radius = 0.5}, Affine3::Identity(), Vec3::Zero(), 0.1));
}

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

/// Two branches of two joints below a root, with random rest rotations: 0 - 1 - 2 and 0 - 3 - 4.
struct Tree {
  explicit Tree(unsigned seed) : random(seed) {
    std::vector<Joint> joints(5);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      joints[j].name = "joint " + std::to_string(j);
      joints[j].parent = j == 0 ? kNoJoint : j == 3 ? 0 : static_cast<JointIndex>(j) - 1;
      joints[j].rest.translation = vector();
      joints[j].rest.rotation = turn();
    }
    skeleton = Skeleton::create(joints).value();
    pose = restPose(skeleton);
    for (JointTransform& joint : pose) joint.rotation = turn();
  }
  Vec3 vector() { return {normal(random), normal(random), normal(random)}; }
  Quat turn() { return Quat(normal(random), normal(random), normal(random), normal(random)).normalized(); }
  [[nodiscard]] Quat rest(JointIndex joint) const { return skeleton.joint(joint).rest.rotation; }

  std::mt19937 random;
  std::normal_distribution<double> normal;
  Skeleton skeleton = strandSkeleton(1);
  Pose pose;
};

/// The same rotation, whichever of its two quaternions.
void expectSame(const Quat& a, const Quat& b) {
  EXPECT_LT(a.angularDistance(b), 1e-7) << a.coeffs().transpose() << " and " << b.coeffs().transpose();
}

TEST(NodeConstraints, RotationCopiesTheSourcesTurnInItsOwnFrame) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Tree tree(seed);
    const Quat turned = tree.rest(2).inverse() * tree.pose[2].rotation;
    const NodeConstraint constraint{.kind = Kind::kRotation, .joint = 4, .source = 2, .weight = 0.3};
    applyConstraints(tree.skeleton, {&constraint, 1}, tree.pose);
    expectSame(tree.pose[4].rotation, tree.rest(4).slerp(0.3, tree.rest(4) * turned));
  }
}

TEST(NodeConstraints, RollFollowsTheFormulaOfTheSpecification) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())}) {
      Tree tree(seed);
      const Quat source = tree.pose[2].rotation;
      const Quat sourceRest = tree.rest(2);
      const Quat rest = tree.rest(4);
      const Quat delta = sourceRest.inverse() * source;
      const Quat deltaInParent = sourceRest * delta * sourceRest.inverse();
      const Quat deltaInJoint = rest.inverse() * deltaInParent * rest;
      const Quat fromTo = Quat::FromTwoVectors(axis, deltaInJoint * axis);
      const Quat expected = rest.slerp(0.7, rest * fromTo.inverse() * deltaInJoint);
      const NodeConstraint constraint{.kind = Kind::kRoll, .joint = 4, .source = 2, .axis = axis, .weight = 0.7};
      applyConstraints(tree.skeleton, {&constraint, 1}, tree.pose);
      expectSame(tree.pose[4].rotation, expected);
    }
  }
}

TEST(NodeConstraints, RollPassesOnATwistAndNothingElse) {
  const Skeleton skeleton = strandSkeleton(3);
  const NodeConstraint constraint{.kind = Kind::kRoll, .joint = 3, .source = 2, .axis = Vec3::UnitX()};
  Pose pose = restPose(skeleton);
  pose[2].rotation = Quat(Eigen::AngleAxisd(0.6, Vec3::UnitX()));
  applyConstraints(skeleton, {&constraint, 1}, pose);
  expectSame(pose[3].rotation, Quat(Eigen::AngleAxisd(0.6, Vec3::UnitX())));
  pose[2].rotation = Quat(Eigen::AngleAxisd(0.6, Vec3::UnitZ()));
  applyConstraints(skeleton, {&constraint, 1}, pose);
  expectSame(pose[3].rotation, Quat::Identity());
}

TEST(NodeConstraints, AimPointsAtTheSource) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(-Vec3::UnitY()), Vec3(Vec3::UnitZ())}) {
      Tree tree(seed);
      NodeConstraint constraint{.kind = Kind::kAim, .joint = 4, .source = 2, .axis = axis};
      applyConstraints(tree.skeleton, {&constraint, 1}, tree.pose);
      const std::vector<Affine3> world = worldOf(tree.skeleton, tree.pose);
      const Vec3 towards = (world[2].translation() - world[4].translation()).normalized();
      EXPECT_NEAR((world[4].linear() * axis - towards).norm(), 0.0, 1e-9);
      // It is the smallest such turn: the one between the two directions.
      Quat parent = tree.pose[0].rotation * tree.pose[3].rotation;
      const Quat turn = Quat::FromTwoVectors(parent * tree.rest(4) * axis, towards);
      expectSame(parent * tree.pose[4].rotation, turn * parent * tree.rest(4));
      // Half the weight is halfway.
      const Quat whole = tree.pose[4].rotation;
      constraint.weight = 0.5;
      applyConstraints(tree.skeleton, {&constraint, 1}, tree.pose);
      expectSame(tree.pose[4].rotation, tree.rest(4).slerp(0.5, whole));
    }
  }
}

TEST(NodeConstraints, ASourceOnTheJointLeavesItAtRest) {
  std::vector<Joint> joints(3);
  joints[1].parent = joints[2].parent = 0;
  const Skeleton skeleton = Skeleton::create(joints).value();
  Pose pose = restPose(skeleton);
  pose[2].rotation = Quat(0.0, 1.0, 0.0, 0.0);
  const NodeConstraint constraint{.kind = Kind::kAim, .joint = 2, .source = 1};
  applyConstraints(skeleton, {&constraint, 1}, pose);
  expectSame(pose[2].rotation, Quat::Identity());
}

TEST(NodeConstraints, AreSortedByWhatTheyDependOn) {
  // 1 follows 3, which follows 4; the aim of 2 depends on its parent 1.
  const Tree tree(1);
  std::vector<NodeConstraint> constraints = {{.kind = Kind::kAim, .joint = 2, .source = 0},
                                             {.kind = Kind::kRotation, .joint = 1, .source = 3},
                                             {.kind = Kind::kRoll, .joint = 3, .source = 4}};
  EXPECT_TRUE(orderConstraints(tree.skeleton, constraints).empty());
  ASSERT_EQ(constraints.size(), 3u);
  EXPECT_EQ(constraints[0].joint, 3);
  EXPECT_EQ(constraints[1].joint, 1);
  EXPECT_EQ(constraints[2].joint, 2);
}

TEST(NodeConstraints, ARollMayFollowAJointBelowIt) {
  // A twist bone between arm and hand turns with the hand, whose own rotation it does not change.
  const Skeleton skeleton = strandSkeleton(3);
  std::vector<NodeConstraint> constraints = {{.kind = Kind::kRoll, .joint = 2, .source = 3}};
  EXPECT_TRUE(orderConstraints(skeleton, constraints).empty());
  EXPECT_EQ(constraints.size(), 1u);
}

TEST(NodeConstraints, CyclesAreBrokenAtOneConstraintEach) {
  const Tree tree(1);
  // 1 -> 3 -> 4 -> 1, and 2 hangs on 1; an aim at a joint below is a cycle of its own.
  std::vector<NodeConstraint> constraints = {
      {.joint = 2, .source = 1}, {.joint = 1, .source = 3}, {.joint = 3, .source = 4}, {.joint = 4, .source = 1}};
  EXPECT_EQ(orderConstraints(tree.skeleton, constraints), std::vector<JointIndex>{4});
  EXPECT_EQ(constraints.size(), 3u);
  constraints = {{.kind = Kind::kAim, .joint = 1, .source = 2}};
  EXPECT_EQ(orderConstraints(tree.skeleton, constraints), std::vector<JointIndex>{1});
  EXPECT_TRUE(constraints.empty());
}

TEST(NodeConstraints, ALongChainOfThemIsSorted) {
  constexpr int kJoints = 100'000;
  const Skeleton skeleton = strandSkeleton(kJoints);
  std::vector<NodeConstraint> constraints;
  for (int j = 1; j < kJoints; ++j) constraints.push_back({.kind = Kind::kAim, .joint = j, .source = 0});
  EXPECT_TRUE(orderConstraints(skeleton, constraints).empty());
  EXPECT_EQ(constraints.size(), static_cast<std::size_t>(kJoints) - 1);
}

TEST(NodeConstraints, ApplyingAllocatesNothing) {
  Tree tree(1);
  const std::vector<NodeConstraint> constraints = {{.kind = Kind::kRotation, .joint = 1, .source = 3},
                                                   {.kind = Kind::kRoll, .joint = 2, .source = 3},
                                                   {.kind = Kind::kAim, .joint = 4, .source = 2}};
  const long before = allocationCount();
  applyConstraints(tree.skeleton, constraints, tree.pose);
  EXPECT_EQ(allocationCount() - before, 0);
}

}  // namespace
}  // namespace lorica::test
