#include "skinning/springs/node_constraints.h"
#include "tests/skinning/springs/strand.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <random>

namespace lorica::test {
namespace {

using Kind = NodeConstraint::Kind;

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
