#include "skinning/morphs/face.h"

#include "skinning/linear_blend.h"
#include "skinning/morphs/look_at.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace lorica {
namespace {

TEST(Blink, ComesEveryTwoToSixSecondsForATenthToAFifthOfASecond) {
  for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1}, ~std::uint64_t{0}}) {
    constexpr double kStep = 0.0005;
    std::vector<double> begins;
    std::vector<double> lengths;
    double shortest = 1.0;
    float closest = 1.0F;  // the least that any blink closes the eyes
    float peak = 0.0F;
    bool closed = false;
    for (int i = 0; i < 2'000'000; ++i) {
      const double time = i * kStep;
      const float weight = blinkWeight(time, seed);
      ASSERT_GE(weight, 0.0F);
      ASSERT_LE(weight, 1.0F);
      if (weight > 0.0F && !closed) begins.push_back(time);
      if (weight == 0.0F && closed) {
        lengths.push_back(time - begins.back());
        shortest = std::min(shortest, lengths.back());
        closest = std::min(closest, peak);
        peak = 0.0F;
      }
      closed = weight > 0.0F;
      peak = std::max(peak, weight);
    }
    ASSERT_GT(begins.size(), 200u);
    EXPECT_GE(begins.front(), 2.0);
    for (std::size_t b = 1; b < begins.size(); ++b) {
      EXPECT_GE(begins[b] - begins[b - 1], 2.0 - kStep);
      EXPECT_LE(begins[b] - begins[b - 1], 6.0 + kStep);
    }
    for (const double length : lengths) {
      EXPECT_GE(length, 0.1 - 2.0 * kStep);
      EXPECT_LE(length, 0.2 + 2.0 * kStep);
    }
    EXPECT_GT(*std::max_element(lengths.begin(), lengths.end()) - shortest, 0.05);
    EXPECT_GT(closest, 0.99F);
  }
}

TEST(Blink, DependsOnTimeAndSeedAlone) {
  EXPECT_EQ(blinkWeight(0.0), 0.0F);  // faces begin with open eyes
  EXPECT_EQ(blinkWeight(std::numeric_limits<double>::quiet_NaN()), 0.0F);
  EXPECT_EQ(blinkWeight(kInfinity), 0.0F);
  int differ = 0;
  for (int i = 0; i < 10000; ++i) {
    const double time = 0.02 * i;
    EXPECT_EQ(blinkWeight(time, 7), blinkWeight(time, 7));
    differ += blinkWeight(time, 7) != blinkWeight(time, 8) ? 1 : 0;
  }
  EXPECT_GT(differ, 100);
}

/// Targets 0 blink, 1 left, 2 up, 3 happy, 4 of a clip.
class FaceTest : public testing::Test {
 protected:
  FaceTest() {
    const char* names[] = {"blink", "lookLeft", "lookUp", "happy"};
    for (int t = 0; t < 5; ++t) {
      morphs.targets.push_back({"target", 0.0F, {}});
      expressions.baseWeights.push_back(0.0F);
      if (t == 4) continue;
      Expression expression;
      expression.name = names[t];
      expression.morphs = {{t, 1.0F}};
      if (t == 3) expression.overrideBlink = ExpressionOverride::kBlock;
      addExpression(expressions, expression);
    }
    lookAt.kind = LookAtKind::kExpression;
    for (LookAtRange* range : {&lookAt.outer, &lookAt.up, &lookAt.down}) *range = {1.0, 0.8};
    while (blinkWeight(blinkTime) < 0.5F) blinkTime += 0.001;
  }

  Morphs morphs;
  Expressions expressions;
  LookAt lookAt;
  double blinkTime = 0.0;
};

TEST_F(FaceTest, BlinksAndLooksWhenNothingDrivesIt) {
  Face face(morphs, expressions, lookAt);
  face.update({blinkTime, {0.5, -2.0}});
  EXPECT_EQ(face.targetWeights()[0], blinkWeight(blinkTime));
  EXPECT_FLOAT_EQ(face.targetWeights()[1], 0.4F);
  EXPECT_FLOAT_EQ(face.targetWeights()[2], 0.8F);
  EXPECT_EQ(face.targetWeights()[3], 0.0F);
  face.setBlinking(false);
  face.update({blinkTime, {}});
  for (const float weight : face.targetWeights()) EXPECT_EQ(weight, 0.0F);
}

TEST_F(FaceTest, ChosenWeightsStayAndOverride) {
  Face face(morphs, expressions, lookAt);
  face.set(3, 0.6F);
  face.set(1, 0.1F);
  face.update({blinkTime, {0.5, -0.5}});
  EXPECT_EQ(face.targetWeights()[0], 0.0F);  // blocked
  EXPECT_EQ(face.targetWeights()[1], 0.1F);  // chosen: the gaze is ignored
  EXPECT_EQ(face.targetWeights()[2], 0.0F);
  EXPECT_EQ(face.targetWeights()[3], 0.6F);
  EXPECT_EQ(face.expressionWeights()[3], 0.6F);
  face.set(3, 0.0F);
  face.set(0, 0.2F);
  face.update({blinkTime, {}});
  EXPECT_EQ(face.targetWeights()[0], 0.2F);
}

TEST_F(FaceTest, AClipSetsTargetsAndExpressionsAddToThem) {
  Face face(morphs, expressions, lookAt);
  const MorphWeightTrack track{3, 2, KeyInterpolation::kLinear, {0.0, 1.0}, {0.0F, 0.0F, 0.5F, 1.0F}};
  face.set(3, 0.25F);
  face.update({blinkTime, {}, std::span(&track, 1), 0.5});
  EXPECT_EQ(face.targetWeights()[0], 0.0F);
  EXPECT_EQ(face.targetWeights()[3], 0.5F);
  EXPECT_EQ(face.targetWeights()[4], 0.5F);
}

TEST_F(FaceTest, AFrameAllocatesNothing) {
  Face face(morphs, expressions, lookAt);
  const MorphWeightTrack track{3, 2, KeyInterpolation::kLinear, {0.0, 1.0}, {0.0F, 0.0F, 0.5F, 1.0F}};
  const long before = test::allocationCount();
  ASSERT_GT(before, 0);
  face.update({blinkTime, {0.1, 0.1}});
  face.update({blinkTime, {}, std::span(&track, 1), 0.5});
  EXPECT_EQ(test::allocationCount() - before, 0);
}

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
