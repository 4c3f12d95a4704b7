#include "skinning/clip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lorica {
namespace {

constexpr double kPi = std::numbers::pi;

[[nodiscard]] Quat aboutY(double angle) {
  return Quat(Eigen::AngleAxisd(angle, Vec3::UnitY()));
}

[[nodiscard]] Quat negated(const Quat& q) {
  return Quat(Eigen::Vector4d(-q.coeffs()));
}

[[nodiscard]] Clip rotationClip(KeyTrack<Quat> track) {
  Clip clip;
  clip.seconds = track.times.back();
  clip.tracks.push_back({1, std::nullopt, std::move(track), std::nullopt});
  return clip;
}

[[nodiscard]] Clip translationClip(KeyTrack<Vec3> track) {
  Clip clip;
  clip.seconds = track.times.back();
  clip.tracks.push_back({1, std::move(track), std::nullopt, std::nullopt});
  return clip;
}

[[nodiscard]] JointTransform at(const Clip& clip, double time) {
  Pose pose(2);
  sampleClip(clip, time, pose);
  return pose[1];
}

TEST(Clip, WhatHasNoTrackIsLeftAlone) {
  Pose pose(3);
  pose[1].scale = Vec3(3.0, 4.0, 5.0);
  pose[1].rotation = aboutY(0.3);
  pose[2].translation = Vec3(7.0, 8.0, 9.0);
  sampleClip(translationClip({KeyInterpolation::kLinear, {0.0}, {Vec3(1.0, 2.0, 3.0)}}), 0.5, pose);
  EXPECT_EQ(pose[1].translation, Vec3(1.0, 2.0, 3.0));
  EXPECT_EQ(pose[1].scale, Vec3(3.0, 4.0, 5.0));
  EXPECT_EQ(pose[1].rotation.coeffs(), aboutY(0.3).coeffs());
  EXPECT_EQ(pose[2].translation, Vec3(7.0, 8.0, 9.0));
  EXPECT_EQ(pose[0].translation, Vec3::Zero());
}

TEST(Clip, BeforeTheFirstKeyAndAfterTheLastTheEndsHold) {
  for (const KeyInterpolation kind : {KeyInterpolation::kStep, KeyInterpolation::kLinear}) {
    const Clip clip = translationClip({kind, {1.0, 2.0}, {Vec3::UnitX(), Vec3::UnitY()}});
    EXPECT_EQ(at(clip, -5.0).translation, Vec3::UnitX());
    EXPECT_EQ(at(clip, 1.0).translation, Vec3::UnitX());
    EXPECT_EQ(at(clip, 2.0).translation, Vec3::UnitY());
    EXPECT_EQ(at(clip, 9.0).translation, Vec3::UnitY());
    EXPECT_EQ(at(clip, std::nan("")).translation, Vec3::UnitX());
  }
}

TEST(Clip, StepsHoldUntilTheNextKey) {
  const Clip clip = translationClip({KeyInterpolation::kStep, {0.0, 1.0, 3.0}, {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}}});
  EXPECT_EQ(at(clip, 0.999).translation.x(), 1.0);
  EXPECT_EQ(at(clip, 1.0).translation.x(), 2.0);
  EXPECT_EQ(at(clip, 2.999).translation.x(), 2.0);
  EXPECT_EQ(at(clip, 3.0).translation.x(), 3.0);
}

TEST(Clip, LinearTranslationsAndScalesGoStraight) {
  Clip clip = translationClip({KeyInterpolation::kLinear, {0.0, 1.0, 3.0}, {{1, 0, 0}, {2, 0, 8}, {4, 0, 0}}});
  clip.tracks[0].scale = KeyTrack<Vec3>{KeyInterpolation::kLinear, {0.0, 4.0}, {{1, 1, 1}, {3, 1, 5}}};
  EXPECT_TRUE(at(clip, 0.25).translation.isApprox(Vec3(1.25, 0.0, 2.0)));
  EXPECT_TRUE(at(clip, 2.5).translation.isApprox(Vec3(3.5, 0.0, 2.0)));
  EXPECT_TRUE(at(clip, 1.0).scale.isApprox(Vec3(1.5, 1.0, 2.0)));
}

TEST(Clip, LinearRotationsTurnEvenlyTheShortWay) {
  // From 0 to 120 degrees; the second key is the antipodal quaternion of the same rotation, and not of unit length.
  Quat far = negated(aboutY(2.0 * kPi / 3.0));
  far.coeffs() *= 2.5;
  const Clip clip = rotationClip({KeyInterpolation::kLinear, {0.0, 2.0}, {Quat::Identity(), far}});
  for (int i = 0; i <= 20; ++i) {
    const double time = 0.1 * i;
    const Quat q = at(clip, time).rotation;
    EXPECT_NEAR(q.norm(), 1.0, 1e-12);
    EXPECT_NEAR(q.angularDistance(aboutY(kPi / 3.0 * time)), 0.0, 1e-7) << time;
  }
}

TEST(Clip, NearlyEqualRotationsStayOfUnitLength) {
  const Clip clip = rotationClip({KeyInterpolation::kLinear, {0.0, 1.0}, {aboutY(0.5), aboutY(0.5 + 1e-9)}});
  EXPECT_NEAR(at(clip, 0.4).rotation.norm(), 1.0, 1e-12);
  EXPECT_NEAR(at(clip, 0.4).rotation.angularDistance(aboutY(0.5)), 0.0, 1e-7);
}

TEST(Clip, CubicSplinesRunThroughACubic) {
  // A Hermite spline reproduces any cubic from its values and slopes at the keys.
  const auto p = [](double t) { return Vec3(t * t * t - 2.0 * t, 3.0 * t * t + 1.0, 5.0 - t); };
  const auto slope = [](double t) { return Vec3(3.0 * t * t - 2.0, 6.0 * t, -1.0); };
  KeyTrack<Vec3> track{KeyInterpolation::kCubicSpline, {0.5, 1.0, 3.0}, {}};
  for (const double t : track.times) track.values.insert(track.values.end(), {slope(t), p(t), slope(t)});
  const Clip clip = translationClip(track);
  for (int i = 0; i <= 50; ++i) {
    const double t = 0.5 + 0.05 * i;
    EXPECT_NEAR((at(clip, t).translation - p(t)).norm(), 0.0, 1e-12) << t;
  }
  EXPECT_EQ(at(clip, 0.0).translation, p(0.5));
  EXPECT_EQ(at(clip, 4.0).translation, p(3.0));
}

TEST(Clip, CubicTangentsOfAKeyDifferOnItsTwoSides) {
  const Vec3 zero = Vec3::Zero();
  const Vec3 up = Vec3::UnitY();
  const Clip clip =
      translationClip({KeyInterpolation::kCubicSpline, {0.0, 2.0}, {{9, 9, 9}, zero, up, zero, zero, {9, 9, 9}}});
  // t^3 - 2 t^2 + t = 1/8 at the middle, times two seconds.
  EXPECT_NEAR((at(clip, 1.0).translation - 0.25 * up).norm(), 0.0, 1e-12);
}

TEST(Clip, CubicRotationsAreNormalisedAfterwards) {
  const Quat none(0.0, 0.0, 0.0, 0.0);
  const Clip clip =
      rotationClip({KeyInterpolation::kCubicSpline, {0.0, 1.0}, {none, aboutY(0.0), none, none, aboutY(1.0), none}});
  const double t = 0.3;
  const double b = 3.0 * t * t - 2.0 * t * t * t;
  const Eigen::Vector4d expected = ((1.0 - b) * aboutY(0.0).coeffs() + b * aboutY(1.0).coeffs()).normalized();
  EXPECT_NEAR((at(clip, t).rotation.coeffs() - expected).norm(), 0.0, 1e-12);
}

TEST(Clip, ASplineThroughZeroGivesSomeRotation) {
  const Quat none(0.0, 0.0, 0.0, 0.0);
  const Clip clip = rotationClip(
      {KeyInterpolation::kCubicSpline, {0.0, 1.0}, {none, aboutY(1.0), none, none, negated(aboutY(1.0)), none}});
  EXPECT_NEAR(at(clip, 0.5).rotation.norm(), 1.0, 1e-12);
}

TEST(Clip, SamplingTheWholeKeepsBothEndsAndEqualSteps) {
  std::vector<Joint> joints(2);
  joints[1].parent = 0;
  joints[1].rest.scale = Vec3(1.0, 2.0, 1.0);
  const Skeleton skeleton = *Skeleton::create(joints);
  Clip clip = translationClip({KeyInterpolation::kLinear, {0.0, 1.03}, {Vec3::Zero(), {1.03, 0, 0}}});
  clip.name = "slide";
  const SkeletalMotion motion = sampleWhole(skeleton, clip, 10.0);
  ASSERT_EQ(motion.frameCount(), 11);
  ASSERT_EQ(motion.poses.size(), 22u);
  EXPECT_EQ(motion.name, "slide");
  EXPECT_EQ(motion.times.front(), 0.0);
  EXPECT_EQ(motion.times.back(), 1.03);
  for (int f = 0; f < 11; ++f) {
    EXPECT_NEAR(motion.times[f], 0.103 * f, 1e-12);
    EXPECT_NEAR(motion.pose(f)[1].translation.x(), 0.103 * f, 1e-12);
    EXPECT_EQ(motion.pose(f)[1].scale, Vec3(1.0, 2.0, 1.0));
  }
}

TEST(Clip, AClipOfNoLengthIsOneFrameAndAShortOneTwo) {
  const Skeleton skeleton = *Skeleton::create(std::vector<Joint>(2, Joint{}));
  EXPECT_EQ(sampleWhole(skeleton, Clip{}, 30.0).frameCount(), 1);
  const Clip brief = translationClip({KeyInterpolation::kLinear, {0.0, 0.001}, {Vec3::Zero(), Vec3::UnitX()}});
  EXPECT_EQ(sampleWhole(skeleton, brief, 30.0).frameCount(), 2);
}

TEST(PoseAt, IsExactAtFramesAndInterpolatesBetween) {
  Joint root;
  root.name = "root";
  SkeletalMotion motion;
  motion.skeleton = Skeleton::create({root}).value();
  motion.times = {1.0, 3.0};
  motion.poses.resize(2);
  motion.poses[1].translation = Vec3(4.0, 0.0, -2.0);
  motion.poses[1].rotation = Quat(Eigen::AngleAxisd(1.0, Vec3::UnitY()));
  motion.poses[1].scale = Vec3::Constant(3.0);
  Pose pose(1);
  for (const auto& [time, share] :
       {std::pair(-5.0, 0.0), {1.0, 0.0}, {1.5, 0.25}, {2.0, 0.5}, {3.0, 1.0}, {9.0, 1.0}}) {
    poseAt(motion, time, pose);
    EXPECT_LT((pose[0].translation - share * Vec3(4.0, 0.0, -2.0)).norm(), 1e-15) << time;
    EXPECT_LT(pose[0].rotation.angularDistance(Quat(Eigen::AngleAxisd(share, Vec3::UnitY()))), 1e-7) << time;
    EXPECT_LT((pose[0].scale - Vec3::Constant(1.0 + 2.0 * share)).norm(), 1e-15) << time;
  }
}

}  // namespace
}  // namespace lorica
