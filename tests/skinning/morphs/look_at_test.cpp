#include "skinning/morphs/look_at.h"

#include "skinning/linear_blend.h"

#include <gtest/gtest.h>

#include <numbers>

namespace lorica {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(LookAt, RangesAreLinearUpToTheirEnd) {
  const LookAtRange range{60.0 * kDegree, 12.0 * kDegree};
  EXPECT_EQ(range(0.0), 0.0);
  EXPECT_NEAR(range(30.0 * kDegree), 6.0 * kDegree, 1e-12);
  EXPECT_NEAR(range(-30.0 * kDegree), 6.0 * kDegree, 1e-12);
  EXPECT_NEAR(range(170.0 * kDegree), 12.0 * kDegree, 1e-12);
}

TEST(LookAt, GazeIsMeasuredFromBetweenTheEyes) {
  LookAt lookAt;
  lookAt.head = 0;
  lookAt.offsetFromHead = Vec3(0.0, 0.1, 0.2);
  const Affine3 head(Eigen::Translation3d(1.0, 1.5, 0.0));
  const Vec3 eyes(1.0, 1.6, 0.2);
  const auto gaze = [&](const Vec3& d) { return gazeTowards(lookAt, head, eyes + d); };
  EXPECT_NEAR(gaze({0, 0, 3}).yaw, 0.0, 1e-12);
  EXPECT_NEAR(gaze({0, 0, 3}).pitch, 0.0, 1e-12);
  EXPECT_NEAR(gaze({2, 0, 2}).yaw, 45.0 * kDegree, 1e-12);  // +X is its left
  EXPECT_NEAR(gaze({-2, 0, 0}).yaw, -90.0 * kDegree, 1e-12);
  EXPECT_NEAR(gaze({0, -2, 2}).pitch, 45.0 * kDegree, 1e-12);  // down
  EXPECT_NEAR(gaze({3, 5, 4}).pitch, -45.0 * kDegree, 1e-12);
  EXPECT_EQ(gaze({0, 0, 0}).yaw, 0.0);
  lookAt.head = kNoJoint;
  EXPECT_EQ(gaze({2, 0, 2}).yaw, 0.0);
}

TEST(LookAt, GazeFollowsTheHeadHoweverItsJointIsTurnedAndScaled) {
  const Quat rest(Eigen::AngleAxisd(2.1, Vec3(1, 2, -1).normalized()));
  LookAt lookAt;
  lookAt.head = 0;
  lookAt.modelFromHead = rest;
  lookAt.offsetFromHead = rest.conjugate() * Vec3(0.0, 6.0, 0.0);  // in centimetres
  const Quat turn(Eigen::AngleAxisd(0.7, Vec3(-1, 3, 1).normalized()));
  const Affine3 worldFromHead = Eigen::Translation3d(4, 5, 6) * turn * rest * Eigen::Scaling(0.01);
  const Vec3 eyes = Vec3(4, 5, 6) + turn * Vec3(0.0, 0.06, 0.0);
  const Gaze gaze = gazeTowards(lookAt, worldFromHead, eyes + turn * Vec3(1.0, -1.0, 1.0));
  EXPECT_NEAR(gaze.yaw, 45.0 * kDegree, 1e-9);
  EXPECT_NEAR(gaze.pitch, std::atan(1.0 / std::sqrt(2.0)), 1e-9);
}

TEST(LookAt, WhatIsBehindIsNotFollowed) {
  const Gaze near = followed({1.0, -0.3});
  EXPECT_EQ(near.yaw, 1.0);
  EXPECT_EQ(near.pitch, -0.3);
  EXPECT_NEAR(followed({-75.0 * kDegree, 0.4}).yaw, -37.5 * kDegree, 1e-12);
  EXPECT_NEAR(followed({-75.0 * kDegree, 0.4}).pitch, 0.2, 1e-12);
  for (const double yaw : {90.0, 135.0, 180.0, -179.0}) {
    EXPECT_NEAR(followed({yaw * kDegree, 0.4}).yaw, 0.0, 1e-12);
    EXPECT_NEAR(followed({yaw * kDegree, 0.4}).pitch, 0.0, 1e-12);
  }
}

TEST(LookAt, ExpressionsTakeTheOuterRangeOnBothSides) {
  LookAt lookAt;
  lookAt.kind = LookAtKind::kExpression;
  lookAt.inner = {1.0, 0.1};
  lookAt.outer = {1.0, 0.5};
  lookAt.down = {1.0, 0.6};
  lookAt.up = {1.0, 0.7};
  const GazeWeights upLeft = gazeWeights(lookAt, {0.5, -0.5});
  EXPECT_FLOAT_EQ(upLeft.left, 0.25F);
  EXPECT_EQ(upLeft.right, 0.0F);
  EXPECT_FLOAT_EQ(upLeft.up, 0.35F);
  EXPECT_EQ(upLeft.down, 0.0F);
  const GazeWeights downRight = gazeWeights(lookAt, {-2.0, 2.0});
  EXPECT_EQ(downRight.left, 0.0F);
  EXPECT_FLOAT_EQ(downRight.right, 0.5F);
  EXPECT_EQ(downRight.up, 0.0F);
  EXPECT_FLOAT_EQ(downRight.down, 0.6F);
  lookAt.kind = LookAtKind::kBone;
  EXPECT_EQ(gazeWeights(lookAt, {0.5, -0.5}).left, 0.0F);
}

TEST(LookAt, TheOuterEyeTurnsByTheOuterRange) {
  LookAt lookAt;
  lookAt.kind = LookAtKind::kBone;
  lookAt.inner = {1.0, 0.1};
  lookAt.outer = {1.0, 0.3};
  lookAt.down = {1.0, 0.2};
  lookAt.up = {1.0, 0.4};
  const auto ahead = [&](const Gaze& gaze, std::size_t eye) {
    return Vec3(eyeRotations(lookAt, gaze)[eye] * Vec3::UnitZ());
  };
  const auto direction = [](double yaw, double pitch) {
    return Vec3(std::sin(yaw) * std::cos(pitch), -std::sin(pitch), std::cos(yaw) * std::cos(pitch));
  };
  EXPECT_TRUE(ahead({0.5, 0.0}, 0).isApprox(direction(0.15, 0.0)));
  EXPECT_TRUE(ahead({0.5, 0.0}, 1).isApprox(direction(0.05, 0.0)));
  EXPECT_TRUE(ahead({-0.5, 0.5}, 0).isApprox(direction(-0.05, 0.1)));
  EXPECT_TRUE(ahead({-0.5, -9.0}, 1).isApprox(direction(-0.15, -0.4)));
}

/// A root, a head, two eyes in odd rest rotations, and a lash on the left one.
TEST(LookAt, EyesTurnAboutThemselvesAndTakeTheirChildrenAlong) {
  JointTransform head;
  head.translation = Vec3(0.0, 1.5, 0.0);
  JointTransform left;
  left.translation = Vec3(0.03, 0.1, 0.08);
  left.rotation = Quat(Eigen::AngleAxisd(1.0, Vec3::UnitX()));
  JointTransform right = left;
  right.translation.x() = -0.03;
  Character character;
  character.skeleton = *Skeleton::create({{"root", kNoJoint, {}, std::nullopt},
                                          {"head", 0, head, HumanBone::kHead},
                                          {"left eye", 1, left, std::nullopt},
                                          {"right eye", 1, right, std::nullopt},
                                          {"lash", 2, {}, std::nullopt}});
  const Pose pose = restPose(character.skeleton);
  std::vector<Affine3> world(5);
  computeWorldFromJoint(character.skeleton, pose, world);
  for (const Affine3& worldFromJoint : world) character.jointFromModel.push_back(worldFromJoint.inverse());

  LookAt lookAt;
  lookAt.kind = LookAtKind::kBone;
  lookAt.inner = lookAt.outer = lookAt.down = lookAt.up = {1.0, 1.0};
  lookAt.head = 1;
  lookAt.leftEye = 2;
  lookAt.rightEye = 3;
  lookAt.modelFromLeftEye = lookAt.modelFromRightEye = left.rotation;

  const Affine3 walk = Eigen::Translation3d(3.0, 0.0, -2.0) * Eigen::AngleAxisd(2.0, Vec3::UnitY());
  std::vector<Affine3> worldFromModel(5, walk);
  turnEyes(character, lookAt, {0.4, 0.2}, worldFromModel);
  for (const std::size_t still : {0, 1}) EXPECT_TRUE(worldFromModel[still].isApprox(walk));
  const Vec3 ahead(std::sin(0.4) * std::cos(0.2), -std::sin(0.2), std::cos(0.4) * std::cos(0.2));
  for (const std::size_t eye : {2, 3, 4}) {
    const Vec3 centre = world[eye].translation();
    EXPECT_TRUE((worldFromModel[eye] * centre).isApprox(walk * centre));
    EXPECT_TRUE((worldFromModel[eye].linear() * Vec3::UnitZ()).isApprox(walk.linear() * ahead, 1e-9));
  }
}

}  // namespace
}  // namespace lorica
