#include "tests/skinning/springs/strand.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lorica::test {
namespace {

constexpr double kStep = kSpringStepSeconds;

/// A body that walks along a line and turns its head, at any instant.
Pose walkerAt(const Skeleton& skeleton, double time) {
  Pose pose = restPose(skeleton);
  pose[0].translation = Vec3(0.0, 1.5 + 0.02 * std::sin(9.0 * time), 1.2 * time);
  pose[0].rotation = Quat(Eigen::AngleAxisd(0.8 * std::sin(4.0 * time), Vec3::UnitY()));
  return pose;
}

TEST(SpringSimulation, WithGravityAloneItHangsDown) {
  const Skeleton skeleton = strandSkeleton(3);
  SpringSimulation springs = simulationOf(
      skeleton, strandSprings(3, {.stiffness = 0.0, .gravityPower = 0.5, .gravityDir = Vec3(0.0, -1.0, 0.0)}));
  Pose pose = restPose(skeleton);
  for (int frame = 0; frame < 3000; ++frame) springs.advance(pose, kStep);
  for (int j = 0; j < 3; ++j) {
    EXPECT_NEAR((springs.tails()[j] - Vec3(0.0, -0.1 * (j + 1), 0.0)).norm(), 0.0, 1e-6) << "joint " << j;
  }
}

TEST(SpringSimulation, WithStiffnessAloneItReturnsToRest) {
  const Skeleton skeleton = strandSkeleton(3);
  SpringSimulation springs = simulationOf(skeleton, strandSprings(3, {.stiffness = 1.0}));
  for (int frame = 0; frame < 30; ++frame) {
    Pose pose = walkerAt(skeleton, frame * kStep);
    springs.advance(pose, kStep);
  }
  Pose pose = walkerAt(skeleton, 0.5);
  for (int frame = 0; frame < 600; ++frame) springs.advance(pose, kStep);
  for (int j = 1; j <= 3; ++j) EXPECT_LT(pose[j].rotation.angularDistance(Quat::Identity()), 1e-7) << "joint " << j;
}

TEST(SpringSimulation, StiffnessAndGravityBalanceAlongTheirSum) {
  const Skeleton skeleton = strandSkeleton(1);
  SpringSimulation springs = simulationOf(
      skeleton, strandSprings(1, {.stiffness = 0.8, .gravityPower = 0.6, .gravityDir = Vec3(0.0, -1.0, 0.0)}));
  Pose pose = restPose(skeleton);
  for (int frame = 0; frame < 2000; ++frame) springs.advance(pose, kStep);
  EXPECT_NEAR((springs.tails()[0] - 0.1 * Vec3(0.8, -0.6, 0.0)).norm(), 0.0, 1e-9);
}

TEST(SpringSimulation, EnergyNeverGrows) {
  // With the body at rest both forces are constant vectors, so the energy of a step of unit mass is its squared length
  // over 2, less the work that the forces can still do.
  const Skeleton skeleton = strandSkeleton(1, 0.3);
  const SpringJoint like{.stiffness = 0.02, .gravityPower = 0.1, .dragForce = 0.02};
  SpringSimulation springs = simulationOf(skeleton, strandSprings(1, like, 0.3));
  const Vec3 force = kStep * (like.stiffness * Vec3::UnitX() + like.gravityPower * Vec3(0.0, -1.0, 0.0));
  Pose pose = restPose(skeleton);
  springs.advance(pose, kStep);
  Vec3 before = springs.tails()[0];
  double lowest = kInfinity;
  double first = 0.0;
  for (int frame = 0; frame < 600; ++frame) {
    springs.advance(pose, kStep);
    const Vec3 tail = springs.tails()[0];
    const double energy = 0.5 * (tail - before).squaredNorm() - force.dot(0.5 * (tail + before));
    if (frame == 0) first = energy;
    EXPECT_LE(energy, lowest + 1e-3 * std::abs(first)) << "frame " << frame;
    lowest = std::min(lowest, energy);
    before = tail;
  }
  EXPECT_LT(lowest, first);
}

TEST(SpringSimulation, LengthsAreKept) {
  const Skeleton skeleton = strandSkeleton(4);
  SpringSimulation springs = simulationOf(skeleton, strandSprings(4, {.stiffness = 0.3, .gravityPower = 1.0}));
  for (int frame = 0; frame < 200; ++frame) {
    Pose pose = walkerAt(skeleton, frame / 47.0);
    springs.advance(pose, 1.0 / 47.0);
    const std::vector<Affine3> world = worldOf(skeleton, pose);
    for (int j = 1; j <= 4; ++j) {
      EXPECT_NEAR((springs.tails()[j - 1] - world[j].translation()).norm(), 0.1, 1e-9);
      // The rotation that was written brings the tail there.
      EXPECT_NEAR((world[j] * Vec3(0.1, 0.0, 0.0) - springs.tails()[j - 1]).norm(), 0.0, 1e-9);
      EXPECT_NEAR(pose[j].rotation.norm(), 1.0, 1e-9);
    }
  }
}

TEST(SpringSimulation, FramesThatAreMultiplesOfAStepGiveTheSame) {
  // The body moves evenly, so that interpolating it is exact.
  const Skeleton skeleton = strandSkeleton(3);
  const auto poseAt = [&](double time) {
    Pose pose = restPose(skeleton);
    pose[0].translation = Vec3(0.9 * time, 0.0, 0.4 * time);
    pose[0].rotation = Quat(Eigen::AngleAxisd(1.1 * time, Vec3::UnitY()));
    return pose;
  };
  const auto tailsAfterOneSecond = [&](int rate) {
    SpringSimulation springs = simulationOf(skeleton, strandSprings(3, {.stiffness = 0.4, .gravityPower = 0.2}));
    for (int frame = 0; frame <= rate; ++frame) {
      Pose pose = poseAt(static_cast<double>(frame) / rate);
      springs.advance(pose, 1.0 / rate);
    }
    return std::vector<Vec3>(springs.tails().begin(), springs.tails().end());
  };
  const std::vector<Vec3> expected = tailsAfterOneSecond(60);
  for (const int rate : {10, 12, 20, 30, 90, 120, 144}) {
    const std::vector<Vec3> tails = tailsAfterOneSecond(rate);
    for (std::size_t j = 0; j < tails.size(); ++j) {
      EXPECT_NEAR((tails[j] - expected[j]).norm(), 0.0, 1e-9) << rate << " frames/s, joint " << j;
    }
  }
}

TEST(SpringSimulation, BetweenStepsTailsMoveContinuously) {
  // Frames of a thousandth of a second: no frame may move a tail much farther than its neighbours do.
  const Skeleton skeleton = strandSkeleton(2);
  SpringSimulation springs = simulationOf(skeleton, strandSprings(2, {.stiffness = 0.5}));
  std::vector<Vec3> path;
  for (int frame = 0; frame < 1000; ++frame) {
    Pose pose = walkerAt(skeleton, 1e-3 * frame);
    springs.advance(pose, 1e-3);
    path.push_back(springs.tails()[1]);
  }
  for (std::size_t i = 101; i < path.size(); ++i) EXPECT_LT((path[i] - path[i - 1]).norm(), 4e-3) << "frame " << i;
}

TEST(SpringSimulation, RunsAreEqualBitForBit) {
  const Skeleton skeleton = strandSkeleton(3);
  SpringSimulation one = simulationOf(skeleton, strandSprings(3, {.stiffness = 0.4, .gravityPower = 0.2}));
  SpringSimulation other = one;
  for (int frame = 0; frame < 100; ++frame) {
    const double seconds = frame % 3 == 0 ? 0.021 : 0.013;
    Pose a = walkerAt(skeleton, 0.016 * frame);
    Pose b = a;
    one.advance(a, seconds);
    other.advance(b, seconds);
    for (std::size_t j = 0; j < a.size(); ++j) ASSERT_EQ(a[j].rotation.coeffs(), b[j].rotation.coeffs());
  }
}

TEST(SpringSimulation, AfterAJumpItStartsAtRest) {
  const Skeleton skeleton = strandSkeleton(3);
  const auto swinging = [&] {
    SpringSimulation springs = simulationOf(skeleton, strandSprings(3, {.stiffness = 0.1, .gravityPower = 0.5}));
    Pose pose = walkerAt(skeleton, 0.0);
    for (int frame = 0; frame < 20; ++frame) springs.advance(pose, kStep);
    EXPECT_GT(pose[1].rotation.angularDistance(Quat::Identity()), 0.1);
    return springs;
  };
  const auto atRest = [&](SpringSimulation springs, double seconds, const Vec3& offset) {
    Pose pose = walkerAt(skeleton, 0.0);
    pose[0].translation += offset;
    springs.advance(pose, seconds);
    return pose[1].rotation.angularDistance(Quat::Identity()) < 1e-12;
  };
  EXPECT_FALSE(atRest(swinging(), kStep, Vec3::Zero()));
  EXPECT_FALSE(atRest(swinging(), 0.2, Vec3::Zero()));
  EXPECT_TRUE(atRest(swinging(), 0.3, Vec3::Zero()));
  EXPECT_TRUE(atRest(swinging(), -1.0, Vec3::Zero()));
  EXPECT_TRUE(atRest(swinging(), std::numeric_limits<double>::quiet_NaN(), Vec3::Zero()));
  EXPECT_TRUE(atRest(swinging(), kStep, Vec3(5.0, 0.0, 0.0)));
  SpringSimulation reset = swinging();
  reset.reset();
  EXPECT_TRUE(atRest(reset, kStep, Vec3::Zero()));
}

TEST(SpringSimulation, ACentreTakesItsMotionOutOfTheMomentum) {
  // The strand hangs on a root that only moves along; relative to the root nothing happens.
  const Skeleton skeleton = strandSkeleton(2);
  SpringBones bones = strandSprings(2, {.stiffness = 0.5});
  const auto largestSwing = [&] {
    SpringSimulation springs = simulationOf(skeleton, bones);
    double largest = 0.0;
    for (int frame = 0; frame < 60; ++frame) {
      Pose pose = restPose(skeleton);
      pose[0].translation = Vec3(0.0, 0.3 * std::sin(0.2 * frame), 0.0);
      springs.advance(pose, kStep);
      largest = std::max(largest, pose[1].rotation.angularDistance(Quat::Identity()));
    }
    return largest;
  };
  EXPECT_GT(largestSwing(), 0.1);
  bones.chains[0].center = 0;
  EXPECT_LT(largestSwing(), 1e-7);
}

TEST(SpringSimulation, TailsRestOnASphere) {
  // The ball lies under the tail of a horizontal strand, so that it pushes at a right angle to it.
  const Skeleton skeleton = strandSkeleton(1);
  SpringBones bones = strandSprings(1, {.stiffness = 0.0, .gravityPower = 0.05, .hitRadius = 0.02});
  bones.colliders.push_back({.joint = 0, .offset = Vec3(0.1, -0.07, 0.0), .radius = 0.05});
  bones.colliderGroups.push_back({0});
  bones.chains[0].colliderGroups = {0};
  SpringSimulation springs = simulationOf(skeleton, bones);
  Pose pose = restPose(skeleton);
  pose[0].translation = Vec3(0.3, 1.0, -0.2);
  for (int frame = 0; frame < 600; ++frame) springs.advance(pose, kStep);
  EXPECT_NEAR((springs.tails()[0] - (pose[0].translation + Vec3(0.1, -0.07, 0.0))).norm(), 0.05 + 0.02, 1e-5);
}

TEST(SpringSimulation, CollidersOnOtherStrandsAreMovedFirst) {
  // Two strands; the first collides with a ball at the end of the second, which comes later in the skeleton.
  std::vector<Joint> joints(3);
  joints[1].parent = 0;
  joints[2].parent = 0;
  joints[2].rest.translation = Vec3(0.0, 0.3, 0.0);
  const Skeleton skeleton = Skeleton::create(joints).value();
  SpringBones bones;
  for (const JointIndex joint : {1, 2}) {
    SpringChain chain;
    chain.joints.push_back({.joint = joint, .tail = Vec3(0.1, 0.0, 0.0), .stiffness = 0.2, .hitRadius = 0.01});
    bones.chains.push_back(chain);
  }
  bones.colliders.push_back({.joint = 2, .offset = Vec3(0.1, -0.2, 0.0), .radius = 0.05});
  bones.colliderGroups.push_back({0});
  bones.chains[0].colliderGroups = {0};
  SpringSimulation springs = simulationOf(skeleton, bones);
  for (int frame = 0; frame < 60; ++frame) {
    Pose pose = restPose(skeleton);
    pose[0].translation = Vec3(0.0, 0.1 * std::sin(0.4 * frame), 0.0);
    springs.advance(pose, kStep);
    const Vec3 ball = worldOf(skeleton, pose)[2] * Vec3(0.1, -0.2, 0.0);
    // Putting the tail back to its distance may leave it a little inside.
    EXPECT_GT((springs.tails()[0] - ball).norm(), 0.055) << "frame " << frame;
  }
}

TEST(SpringSimulation, ObstaclesSeeEveryStepAndTheirAnswerIsKept) {
  struct Floor final : SpringObstacles {
    void moveTo(double share) override { shares.push_back(share); }
    void pushOut(std::size_t /*spring*/, const Vec3& head, double length, Vec3& tail) override {
      if (tail.y() >= -0.05) return;
      tail = head + Vec3(std::sqrt(length * length - 0.0025), -0.05, 0.0);
    }
    std::vector<double> shares;
  } floor;
  const Skeleton skeleton = strandSkeleton(1);
  SpringSimulation springs = simulationOf(skeleton, strandSprings(1, {.stiffness = 0.0, .gravityPower = 1.0}));
  Pose pose = restPose(skeleton);
  springs.advance(pose, 0.0, &floor);
  springs.advance(pose, 2.5 * kStep, &floor);
  ASSERT_EQ(floor.shares.size(), 3u);
  EXPECT_NEAR(floor.shares[0], 0.4, 1e-12);
  EXPECT_NEAR(floor.shares[1], 0.8, 1e-12);
  EXPECT_EQ(floor.shares[2], 1.0);
  for (int frame = 0; frame < 200; ++frame) springs.advance(pose, kStep, &floor);
  EXPECT_NEAR(springs.tails()[0].y(), -0.05, 1e-12);
}

TEST(SpringSimulation, AScaledRootScalesTheMotion) {
  constexpr double kScale = 10.0;
  Skeleton skeleton = strandSkeleton(3);
  std::vector<Joint> joints(skeleton.joints().begin(), skeleton.joints().end());
  joints[0].rest.scale.setConstant(kScale);
  const Skeleton large = Skeleton::create(joints).value();
  SpringBones bones = strandSprings(3, {.stiffness = 0.3, .gravityPower = 0.2, .hitRadius = 0.02});
  bones.colliders.push_back({.joint = 0, .offset = Vec3(0.15, -0.05, 0.0), .radius = 0.05});
  bones.colliderGroups.push_back({0});
  bones.chains[0].colliderGroups = {0};
  SpringSimulation springs = simulationOf(skeleton, bones);
  SpringSimulation largeSprings = simulationOf(large, bones);
  for (int frame = 0; frame < 60; ++frame) {
    Pose pose = walkerAt(skeleton, frame * kStep);
    Pose largePose = pose;
    largePose[0].translation *= kScale;
    largePose[0].scale.setConstant(kScale);
    springs.advance(pose, kStep);
    largeSprings.advance(largePose, kStep);
    for (int j = 0; j < 3; ++j) {
      ASSERT_LT((largeSprings.tails()[j] - kScale * springs.tails()[j]).norm(), 1e-9) << "frame " << frame;
    }
  }
}

TEST(SpringSimulation, AJointOfScaleZeroKeepsStill) {
  std::vector<Joint> joints(2);
  joints[0].rest.scale = Vec3::Zero();
  joints[1].parent = 0;
  const Skeleton skeleton = Skeleton::create(joints).value();
  SpringSimulation springs = simulationOf(skeleton, strandSprings(1, {.gravityPower = 1.0}));
  Pose pose = restPose(skeleton);
  for (int frame = 0; frame < 10; ++frame) springs.advance(pose, kStep);
  EXPECT_EQ(pose[1].rotation.coeffs(), Quat::Identity().coeffs());
}

TEST(SpringSimulation, TheHundredThousandthJointOfAStrandSwings) {
  const Skeleton skeleton = strandSkeleton(100'000, 1e-3);
  SpringBones bones = strandSprings(1, {.gravityPower = 1.0}, 1e-3);
  bones.chains[0].joints[0].joint = 100'000;
  SpringSimulation springs = simulationOf(skeleton, bones);
  Pose pose = restPose(skeleton);
  for (int frame = 0; frame < 10; ++frame) springs.advance(pose, kStep);
  EXPECT_GT(pose.back().rotation.angularDistance(Quat::Identity()), 0.1);
}

TEST(SpringSimulation, AdvancingAllocatesNothing) {
  const Skeleton skeleton = strandSkeleton(5);
  SpringBones bones = strandSprings(4, {.stiffness = 0.4, .gravityPower = 0.2, .hitRadius = 0.02});
  bones.colliders.push_back({.joint = 0, .offset = Vec3(0.1, -0.07, 0.0), .radius = 0.05});
  bones.colliderGroups.push_back({0});
  bones.chains[0].colliderGroups = {0};
  bones.constraints.push_back({.kind = NodeConstraint::Kind::kAim, .joint = 5, .source = 0});
  SpringSimulation springs = simulationOf(skeleton, bones);
  Pose pose = walkerAt(skeleton, 0.0);
  const long before = allocationCount();
  ASSERT_GT(before, 0);
  for (int frame = 0; frame < 50; ++frame) {
    pose[0].rotation = Quat(Eigen::AngleAxisd(0.1 * frame, Vec3::UnitY()));
    springs.advance(pose, 0.023);
  }
  EXPECT_EQ(allocationCount() - before, 0);
}

}  // namespace
}  // namespace lorica::test
