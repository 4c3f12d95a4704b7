#include "capture/retarget/skeletal_retarget.h"

#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "capture/retarget/retarget_rig.h"
#include "geometry/random_numbers.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/figures.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace lorica {
namespace {

using test::angleBetween;
using test::degrees;
using test::Figure;
using test::FigureSettings;
using test::makeFigure;
using test::PersonPose;
using test::randomPose;
using B = HumanBone;

std::vector<Affine3> worldOf(const SkeletalMotion& motion, int frame) {
  const std::span<const JointTransform> pose = motion.pose(frame);
  return test::worldOf(motion.skeleton, Pose(pose.begin(), pose.end()));
}

Vec3 positionOf(const Skeleton& skeleton, const std::vector<Affine3>& world, B bone) {
  return world[skeleton.jointOf(bone)].translation();
}

Quat rotationOf(const Skeleton& skeleton, const std::vector<Affine3>& world, B bone) {
  const Mat3 linear = world[skeleton.jointOf(bone)].linear();
  return Quat(Mat3(linear / std::cbrt(linear.determinant())));
}

/// A random figure: rest pose, which may be lying or face any direction, joint axes and lengths depend on the seed.
Figure anyFigure(std::uint64_t seed) {
  RandomNumbers random(seed);
  FigureSettings settings;
  settings.seed = static_cast<std::uint32_t>(seed);
  settings.armsDown = degrees(random.between(-30.0, 85.0));
  settings.legsApart = degrees(random.between(0.0, 25.0));
  settings.elbowsBent = degrees(random.between(0.0, 30.0));
  settings.crookedAxes = random.unit() < 0.7;
  settings.yaw = degrees(random.between(-180.0, 180.0));
  settings.scale = random.between(0.3, 2.0);
  settings.thigh = random.between(0.3, 0.5);
  settings.shin = random.between(0.3, 0.5);
  settings.upperArm = random.between(0.2, 0.35);
  settings.forearm = random.between(0.2, 0.35);
  settings.armature = random.unit() < 0.3;
  settings.fullSpine = random.unit() < 0.6;
  Figure figure = makeFigure(settings);
  std::vector<Joint> joints(figure.skeleton.joints().begin(), figure.skeleton.joints().end());
  JointTransform& root = joints[0].rest;
  if (random.unit() < 0.3) {  // lies on its back, with its feet far from y = 0
    const Quat lying(Eigen::AngleAxisd(-degrees(90.0), Vec3::UnitX()));
    root.rotation = lying * root.rotation;
    root.translation = lying * root.translation;
  }
  figure.skeleton = *Skeleton::create(std::move(joints));
  return figure;
}

/// Known poses of a figure: the world rotation of a limb is its rotation times its T-pose rotation.
SkeletalMotion motionOf(const Figure& figure, const std::vector<PersonPose>& people) {
  SkeletalMotion motion;
  motion.skeleton = figure.skeleton;
  const std::span<const Joint> joints = figure.skeleton.joints();
  for (const PersonPose& person : people) {
    motion.times.push_back(static_cast<double>(motion.times.size()) / 30.0);
    Pose pose = restPose(figure.skeleton);
    std::vector<Quat> world(joints.size());
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const Quat above = joints[j].parent == kNoJoint ? Quat::Identity() : world[joints[j].parent];
      world[j] = above * pose[j].rotation;
      const auto take = [&](const Quat& turn) { world[j] = turn * figure.tposeRotation[j]; };
      if (joints[j].bone) {
        const B bone = *joints[j].bone;
        if (bone == B::kHips) take(person.hips);
        if (bone == B::kSpine || bone == B::kChest || bone == B::kUpperChest) take(person.chest);
        if (bone == B::kLeftShoulder || bone == B::kRightShoulder) take(person.chest);
        if (bone == B::kNeck) take(person.neck);
        if (bone == B::kHead) take(person.head);
        for (std::size_t i = 0; i < kLimbCount; ++i) {
          if (bone == limbs()[i].upper) take(person.upper[i]);
          if (bone == limbs()[i].lower) take(person.lower[i]);
          if (bone == limbs()[i].end) take(person.end[i]);
        }
        if (bone == B::kLeftToes) take(person.end[2]);
        if (bone == B::kRightToes) take(person.end[3]);
        if (bone == B::kLeftMiddleProximal) take(person.end[0]);
        if (bone == B::kRightMiddleProximal) take(person.end[1]);
      }
      pose[j].rotation = (above.conjugate() * world[j]).normalized();
    }
    motion.poses.insert(motion.poses.end(), pose.begin(), pose.end());
  }
  return motion;
}

std::vector<PersonPose> randomPoses(std::uint32_t seed) {
  std::vector<PersonPose> people;
  for (std::uint32_t i = 0; i < 10; ++i) people.push_back(randomPose(100 * seed + i));
  return people;
}

SkeletalMotion retargeted(const SkeletalMotion& source, const Skeleton& target, bool plantFeet, bool mirror = false) {
  Result<SkeletalMotion> out = retargetMotion(source, target, {.mirror = mirror, .plantFeet = plantFeet});
  EXPECT_TRUE(out) << out.error().message;
  return std::move(*out);
}

TEST(MotionRetarget, DirectionsAndTwistsAgreeWhateverTheRestPose) {
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    const Figure from = anyFigure(seed);
    const Figure to = anyFigure(seed + 1000);
    const std::vector<PersonPose> people = randomPoses(seed);
    const SkeletalMotion out = retargeted(motionOf(from, people), to.skeleton, false);
    ASSERT_EQ(out.frameCount(), static_cast<int>(people.size()));
    for (int f = 0; f < out.frameCount(); ++f) {
      const PersonPose& person = people[f];
      const std::vector<Affine3> world = worldOf(out, f);
      const auto expectTurn = [&](B bone, const Quat& turn) {
        const JointIndex joint = to.skeleton.jointOf(bone);
        if (joint == kNoJoint || from.skeleton.jointOf(bone) == kNoJoint) return;
        const Quat expected = turn * to.tposeRotation[joint];
        ASSERT_LT(rotationOf(to.skeleton, world, bone).angularDistance(expected), degrees(0.1)) << nameOf(bone);
      };
      for (std::size_t i = 0; i < kLimbCount; ++i) {
        const LimbBones& limb = limbs()[i];
        const auto direction = [&](B a, B b) -> Vec3 {
          return positionOf(to.skeleton, world, b) - positionOf(to.skeleton, world, a);
        };
        ASSERT_LT(angleBetween(direction(limb.upper, limb.lower), person.upper[i] * limb.axis), degrees(0.1));
        ASSERT_LT(angleBetween(direction(limb.lower, limb.end), person.lower[i] * limb.axis), degrees(0.1));
        expectTurn(limb.upper, person.upper[i]);
        expectTurn(limb.lower, person.lower[i]);
        expectTurn(limb.end, person.end[i]);
      }
      expectTurn(B::kHips, person.hips);
      expectTurn(to.skeleton.jointOf(B::kUpperChest) == kNoJoint ? B::kSpine : B::kUpperChest, person.chest);
      expectTurn(B::kNeck, person.neck);
      expectTurn(B::kHead, person.head);
      expectTurn(B::kLeftToes, person.end[2]);
      expectTurn(B::kRightMiddleProximal, person.end[1]);
    }
  }
}

TEST(MotionRetarget, ASpineOfOtherCountBendsAsMuchInAll) {
  FigureSettings one;
  one.fullSpine = false;
  FigureSettings three;
  for (const bool toMore : {false, true}) {
    const Figure from = makeFigure(toMore ? one : three);
    const Figure to = makeFigure(toMore ? three : one);
    PersonPose bent;
    bent.hips = Quat(Eigen::AngleAxisd(degrees(10.0), Vec3::UnitX()));
    bent.chest = Quat(Eigen::AngleAxisd(degrees(70.0), Vec3::UnitX()));
    const SkeletalMotion out = retargeted(motionOf(from, {bent}), to.skeleton, false);
    const std::vector<Affine3> world = worldOf(out, 0);
    const B top = toMore ? B::kUpperChest : B::kSpine;
    EXPECT_LT(rotationOf(to.skeleton, world, top).angularDistance(bent.chest), degrees(0.1));
    if (!toMore) continue;
    EXPECT_LT(rotationOf(to.skeleton, world, B::kSpine)
                  .angularDistance(Quat(Eigen::AngleAxisd(degrees(30.0), Vec3::UnitX()))),
              degrees(0.1));
    EXPECT_LT(rotationOf(to.skeleton, world, B::kChest)
                  .angularDistance(Quat(Eigen::AngleAxisd(degrees(50.0), Vec3::UnitX()))),
              degrees(0.1));
  }
}

TEST(MotionRetarget, OntoItselfNothingChanges) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const Figure figure = anyFigure(seed);
    const SkeletalMotion source = motionOf(figure, randomPoses(seed));
    const SkeletalMotion out = retargeted(source, figure.skeleton, false);
    for (std::size_t i = 0; i < source.poses.size(); ++i) {
      ASSERT_LT(out.poses[i].rotation.angularDistance(source.poses[i].rotation), degrees(0.01));
    }
  }
}

TEST(MotionRetarget, WhatTheSourceLacksStaysAtRest) {
  const Figure figure = makeFigure({});
  std::vector<Joint> joints(figure.skeleton.joints().begin(), figure.skeleton.joints().end());
  for (Joint& joint : joints) {
    if (joint.bone == B::kLeftShoulder || joint.bone == B::kLeftToes || joint.bone == B::kLeftMiddleProximal) {
      joint.bone.reset();
    }
  }
  SkeletalMotion source = motionOf(figure, {randomPose(3)});
  source.skeleton = *Skeleton::create(joints);
  const SkeletalMotion out = retargeted(source, figure.skeleton, false);
  for (const B bone : {B::kLeftShoulder, B::kLeftToes, B::kLeftMiddleProximal}) {
    const JointIndex joint = figure.skeleton.jointOf(bone);
    EXPECT_EQ(out.poses[joint].rotation.coeffs(), figure.skeleton.joint(joint).rest.rotation.coeffs());
  }
}

TEST(MotionRetarget, MissingBonesAreNamed) {
  const Figure figure = makeFigure({});
  Joint only;
  only.name = "Root";
  only.bone = B::kHips;
  SkeletalMotion motion;
  motion.name = "wave";
  motion.skeleton = *Skeleton::create({only});
  motion.times = {0.0};
  motion.poses = restPose(motion.skeleton);
  const Result<SkeletalMotion> poor = retargetMotion(motion, figure.skeleton);
  ASSERT_FALSE(poor);
  EXPECT_EQ(poor.error().message.substr(0, 75),
            "the motion wave: the skeleton lacks humanoid bones that retargeting needs: ");
  const Result<SkeletalMotion> other = retargetMotion(motionOf(figure, {PersonPose()}), motion.skeleton);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().message.substr(0, 71),
            "the character: the skeleton lacks humanoid bones that retargeting needs");
  motion.times.clear();
  EXPECT_FALSE(retargetMotion(motion, figure.skeleton));
}

TEST(MotionRetarget, TwoMirrorsShowTheMotionItself) {
  const Figure figure = makeFigure({});
  const std::vector<PersonPose> people = randomPoses(5);
  const SkeletalMotion source = motionOf(figure, people);
  const SkeletalMotion once = retargeted(source, figure.skeleton, false, true);
  const SkeletalMotion twice = retargeted(once, figure.skeleton, false, true);
  for (int f = 0; f < source.frameCount(); ++f) {
    const std::vector<Affine3> before = worldOf(source, f);
    const std::vector<Affine3> mirror = worldOf(once, f);
    for (std::size_t j = 0; j < before.size(); ++j) {
      const std::optional<B> bone = figure.skeleton.joint(static_cast<JointIndex>(j)).bone;
      if (!bone) continue;
      // The figure is symmetric, so joints are at mirrored positions, except for the root's height.
      const Vec3 there =
          positionOf(figure.skeleton, before, otherSide(*bone)) - positionOf(figure.skeleton, before, B::kHips);
      const Vec3 here = positionOf(figure.skeleton, mirror, *bone) - positionOf(figure.skeleton, mirror, B::kHips);
      EXPECT_LT((here - Vec3(-there.x(), there.y(), there.z())).norm(), 1e-9) << nameOf(*bone);
    }
  }
  for (std::size_t i = 0; i < source.poses.size(); ++i) {
    EXPECT_LT(twice.poses[i].rotation.angularDistance(source.poses[i].rotation), 1e-6);
  }
}

/// Worst values for one motion on another skeleton. Stances are detected independently here: the ankle moves slower
/// than 0.2 m/s and is within 8 cm of its lowest position, for legs of 0.85 m.
struct Figures {
  double slide = 0.0;       ///< of a sole in a stance, beyond the scaled slide of the source: of its ball if the
                            ///< source's ball moved less than its ankle, else of the ankle [m]
  double ankleSlide = 0.0;  ///< of the ankle, also while the foot rolls [m]
  int stances = 0;
  double limbs = 0.0;          ///< between directions of arms and neck [rad]
  double kneeBackwards = 0.0;  ///< sine
  double lowestSole = 0.0;     ///< [m]
  double jerk = 0.0;           ///< of an ankle's acceleration beyond the source's, over 3 frames [m]
};

Figures measure(const SkeletalMotion& source, const SkeletalMotion& out) {
  const RetargetRig from = *RetargetRig::create(source.skeleton);
  const RetargetRig to = *RetargetRig::create(out.skeleton);
  const double ratio = to.legLength / from.legLength;
  const double size = from.legLength / 0.85;
  std::array<std::vector<Vec3>, 2> theirs;
  std::array<std::vector<Vec3>, 2> ankles;
  std::array<std::vector<Vec3>, 2> theirBalls;
  std::array<std::vector<Vec3>, 2> balls;
  Figures worst;
  for (int f = 0; f < source.frameCount(); ++f) {
    const std::vector<Affine3> a = worldOf(source, f);
    const std::vector<Affine3> b = worldOf(out, f);
    const auto has = [&](B bone) {
      return source.skeleton.jointOf(bone) != kNoJoint && out.skeleton.jointOf(bone) != kNoJoint;
    };
    if (has(B::kNeck) && has(B::kHead)) {
      worst.limbs = std::max(
          worst.limbs, angleBetween(positionOf(source.skeleton, a, B::kHead) - positionOf(source.skeleton, a, B::kNeck),
                                    positionOf(out.skeleton, b, B::kHead) - positionOf(out.skeleton, b, B::kNeck)));
    }
    for (std::size_t i = 0; i < kLimbCount; ++i) {
      const LimbBones& limb = limbs()[i];
      const auto direction = [&](const Skeleton& skeleton, const std::vector<Affine3>& world, B x, B y) -> Vec3 {
        return (positionOf(skeleton, world, y) - positionOf(skeleton, world, x)).normalized();
      };
      if (i < kFirstLeg) {
        for (const auto& [x, y] : {std::pair(limb.upper, limb.lower), std::pair(limb.lower, limb.end)}) {
          const double angle = angleBetween(direction(source.skeleton, a, x, y), direction(out.skeleton, b, x, y));
          worst.limbs = std::max(worst.limbs, angle);
        }
        continue;
      }
      const std::size_t side = i - kFirstLeg;
      const auto thighJoint = static_cast<std::size_t>(out.skeleton.jointOf(limb.upper));
      const Vec3 hinge =
          rotationOf(out.skeleton, b, limb.upper) * (to.tposeFromJoint[thighJoint].conjugate() * Vec3::UnitX());
      const Vec3 bend =
          direction(out.skeleton, b, limb.upper, limb.lower).cross(direction(out.skeleton, b, limb.lower, limb.end));
      worst.kneeBackwards = std::max(worst.kneeBackwards, -bend.dot(hinge));
      const B toesBone = side == 0 ? B::kLeftToes : B::kRightToes;
      const bool hasToes = out.skeleton.jointOf(toesBone) != kNoJoint;
      const Affine3& foot = b[out.skeleton.jointOf(limb.end)];
      const Affine3& tip = hasToes ? b[out.skeleton.jointOf(toesBone)] : foot;
      const RetargetRig::Sole& sole = to.sole[side];
      worst.lowestSole =
          std::min({worst.lowestSole, (foot * sole.heel).y(), (foot * sole.ball).y(), (tip * sole.tip).y()});
      theirs[side].push_back(positionOf(source.skeleton, a, limb.end));
      ankles[side].push_back(foot.translation());
      theirBalls[side].emplace_back(a[source.skeleton.jointOf(limb.end)] * from.sole[side].ball);
      balls[side].emplace_back(foot * sole.ball);
    }
  }
  for (std::size_t side = 0; side < 2; ++side) {
    double floor = 1e9;
    for (const Vec3& p : theirs[side]) floor = std::min(floor, p.y());
    std::size_t start = 0;
    bool stands = false;
    for (std::size_t f = 1; f < theirs[side].size(); ++f) {
      const double step = source.times[f] - source.times[f - 1];
      const bool still = (theirs[side][f] - theirs[side][f - 1]).norm() < 0.2 * size * step &&
                         theirs[side][f].y() < floor + 0.08 * size;
      if (still && !stands) {
        start = f - 1;
        ++worst.stances;
      }
      stands = still;
      if (still) {
        const auto level = [](const Vec3& v) { return std::hypot(v.x(), v.z()); };
        const auto since = [&](const std::vector<Vec3>& p) { return level(p[f] - p[start]); };
        const double ankle = since(ankles[side]) - ratio * since(theirs[side]);
        const double ball = since(balls[side]) - ratio * since(theirBalls[side]);
        worst.slide = std::max(worst.slide, since(theirBalls[side]) < since(theirs[side]) ? ball : ankle);
        worst.ankleSlide = std::max(worst.ankleSlide, ankle);
      }
      if (f < 2) continue;
      const auto change = [&](const std::vector<Vec3>& p) { return (p[f] - 2.0 * p[f - 1] + p[f - 2]).norm(); };
      worst.jerk = std::max(worst.jerk, change(ankles[side]) - 1.5 * ratio * change(theirs[side]));
    }
  }
  if (std::getenv("LORICA_PRINT_MEASURES") != nullptr) {
    std::printf("%-16s stances %3d slide %.2f cm, ankle %.2f cm, arms %.3f deg, knee %.4f, sole %.4f m, jerk %.4f m\n",
                out.name.c_str(), worst.stances, 100.0 * worst.slide, 100.0 * worst.ankleSlide,
                worst.limbs / degrees(1.0), worst.kneeBackwards, worst.lowestSole, worst.jerk);
  }
  return worst;
}

std::vector<Skeleton> targets() {
  std::vector<Skeleton> all = {makeMannequin().skeleton};
  FigureSettings longLegs;
  longLegs.thigh = 0.32;
  longLegs.shin = 0.50;
  longLegs.crookedAxes = true;
  all.push_back(makeFigure(longLegs).skeleton);
  FigureSettings small;
  small.scale = 0.4;
  small.thigh = 0.5;
  small.armature = true;
  small.armsDown = degrees(60.0);
  all.push_back(makeFigure(small).skeleton);
  return all;
}

void expectGoodFeet(const SkeletalMotion& source, int minStances) {
  for (const Skeleton& target : targets()) {
    const double size = RetargetRig::create(target)->legLength / 0.85;
    const Figures worst = measure(source, retargeted(source, target, true));
    EXPECT_GE(worst.stances, minStances);
    EXPECT_LT(worst.slide, 0.01);
    EXPECT_LT(worst.limbs, degrees(0.1));
    EXPECT_LT(worst.kneeBackwards, 0.02);
    EXPECT_GT(worst.lowestSole, -0.001);
    EXPECT_LT(worst.jerk, 0.05 * size);
  }
}

/// A foot of twice the length rolls on its ball when the source's foot does.
void expectGoodRolls(const SkeletalMotion& source, double farthest) {
  FigureSettings bigFeet;
  bigFeet.toesAhead = 0.26;
  EXPECT_LT(measure(source, retargeted(source, makeFigure(bigFeet).skeleton, true)).slide, farthest);
}

class RecordedFeet : public ::testing::TestWithParam<const char*> {};

TEST_P(RecordedFeet, StandWhereTheyStood) {
  const auto frames = test::valueOf(readJointCsv(test::recordingsFolder() / (std::string(GetParam()) + ".csv")));
  SkeletalMotion source = test::valueOf(skeletalMotionOf(frames));
  source.name = GetParam();
  expectGoodFeet(source, 2);
  expectGoodRolls(source, 0.002);
}

INSTANTIATE_TEST_SUITE_P(All, RecordedFeet,
                         ::testing::Values("walk", "wave", "jumping_jacks", "squat_and_reach", "punch_and_kick",
                                           "turn_around"),
                         [](const auto& chosen) { return std::string(chosen.param); });

struct BvhCase {
  const char* path;
  int minStances;
};
class SharedBvhOn : public ::testing::TestWithParam<BvhCase> {};

TEST_P(SharedBvhOn, OtherSkeletons) {
  LORICA_REQUIRE_DATASET(path, GetParam().path);
  const BvhFile file = test::valueOf(readBvh(path));
  expectGoodFeet(file.motion, GetParam().minStances);
  expectGoodRolls(file.motion, 0.01);
}

INSTANTIATE_TEST_SUITE_P(All, SharedBvhOn,
                         ::testing::Values(BvhCase{"bvh/animated_drawings/jumping_jacks.bvh", 10},
                                           BvhCase{"bvh/animated_drawings/zombie.bvh", 20},
                                           BvhCase{"bvh/makehuman/walk1.bvh", 0},
                                           BvhCase{"bvh/makehuman/zombieWalk1.bvh", 1},
                                           BvhCase{"bvh/makehuman/tpose.bvh", 0}),
                         [](const auto& chosen) { return std::filesystem::path(chosen.param.path).stem().string(); });

TEST(MotionRetarget, TheRootMovesByTheRatioOfLegLengths) {
  FigureSettings half;
  half.scale = 0.5;
  const Figure from = makeFigure({});
  const Figure to = makeFigure(half);
  SkeletalMotion source = motionOf(from, std::vector<PersonPose>(30));
  const auto joints = static_cast<std::size_t>(from.skeleton.jointCount());
  // Slides on ice, so that no foot stands, above a floor at y = -3.
  for (std::size_t f = 0; f < 30; ++f) {
    source.poses[f * joints].translation += Vec3(0.1 * static_cast<double>(f), -3.0, 2.0);
  }
  const SkeletalMotion out = retargeted(source, to.skeleton, true);
  for (int f = 0; f < 30; ++f) {
    const std::vector<Affine3> a = worldOf(source, f);
    const std::vector<Affine3> b = worldOf(out, f);
    EXPECT_NEAR(positionOf(to.skeleton, b, B::kHips).x(), 0.05 * f, 1e-9);
    EXPECT_NEAR(positionOf(to.skeleton, b, B::kHips).z(), positionOf(from.skeleton, a, B::kHips).z(), 1e-9);
    EXPECT_NEAR(positionOf(to.skeleton, b, B::kLeftFoot).y(), 0.04, 1e-9) << "the ankle is at its rest height";
  }
}

TEST(MotionRetarget, AJumpIsAsHighAsTheLegsAreLong) {
  FigureSettings half;
  half.scale = 0.5;
  const Figure from = makeFigure({});
  const Figure to = makeFigure(half);
  SkeletalMotion source = motionOf(from, std::vector<PersonPose>(60));
  const auto joints = static_cast<std::size_t>(from.skeleton.jointCount());
  const auto height = [](int f) { return f < 30 ? 0.0 : std::max(0.0, 0.4 * std::sin((f - 30) * degrees(12.0))); };
  for (int f = 0; f < 60; ++f) source.poses[static_cast<std::size_t>(f) * joints].translation.y() += height(f);
  const SkeletalMotion out = retargeted(source, to.skeleton, true);
  for (int f = 0; f < 60; ++f) {
    EXPECT_NEAR(positionOf(to.skeleton, worldOf(out, f), B::kLeftFoot).y(), 0.04 + 0.5 * height(f), 1e-3) << f;
  }
}

TEST(RetargetByJointNames, TheSameSkeletonTakesTheMotionAsItIs) {
  const Figure figure = makeFigure({});
  const SkeletalMotion source = motionOf(figure, randomPoses(1));
  const SkeletalMotion out = test::valueOf(retargetByJointNames(source, figure.skeleton));
  for (int f = 0; f < source.frameCount(); ++f) {
    const std::vector<Affine3> a = worldOf(source, f);
    const std::vector<Affine3> b = worldOf(out, f);
    for (std::size_t j = 0; j < a.size(); ++j) EXPECT_TRUE(a[j].isApprox(b[j], 1e-9)) << f << " " << j;
  }
}

TEST(RetargetByJointNames, NodesAboveAndBetweenAreSeenThrough) {
  const Figure figure = makeFigure({});
  const SkeletalMotion plain = motionOf(figure, randomPoses(1));
  // The same motion, with its joints under a rotated scene in centimetres and a node with half of the left thigh's
  // rotation.
  SkeletalMotion deep;
  deep.times = plain.times;
  const JointIndex thigh = figure.skeleton.jointOf(B::kLeftUpperLeg);
  std::vector<Joint> joints(1);
  joints[0].name = "Scene";
  joints[0].rest.rotation = Quat(Eigen::AngleAxisd(degrees(-90.0), Vec3::UnitX()));
  joints[0].rest.scale = Vec3::Constant(0.01);
  std::vector<JointIndex> moved;
  for (JointIndex j = 0; j < figure.skeleton.jointCount(); ++j) {
    Joint joint = figure.skeleton.joint(j);
    joint.name = "take:" + joint.name;
    joint.parent = joint.parent == kNoJoint ? 0 : moved[joint.parent];
    joint.rest.translation *= 100.0;
    if (j == thigh) {
      Joint between;
      between.name = "between";
      between.parent = joint.parent;
      between.rest.translation = joint.rest.translation;
      joint.rest.translation.setZero();
      joint.parent = static_cast<JointIndex>(joints.size());
      joints.push_back(between);
    }
    moved.push_back(static_cast<JointIndex>(joints.size()));
    joints.push_back(joint);
  }
  deep.skeleton = *Skeleton::create(joints);
  for (int f = 0; f < plain.frameCount(); ++f) {
    Pose pose = restPose(deep.skeleton);
    for (JointIndex j = 0; j < figure.skeleton.jointCount(); ++j) {
      const JointTransform& from = plain.pose(f)[j];
      JointTransform& to = pose[moved[static_cast<std::size_t>(j)]];
      to.rotation = from.rotation;
      if (j != thigh) to.translation = 100.0 * from.translation;
      if (figure.skeleton.joint(j).parent == kNoJoint) {
        to.rotation = joints[0].rest.rotation.conjugate() * from.rotation;
        to.translation = 100.0 * (joints[0].rest.rotation.conjugate() * from.translation);
      }
      if (j == thigh) {
        const Quat half = Quat::Identity().slerp(0.5, from.rotation);
        pose[static_cast<std::size_t>(moved[j]) - 1].rotation = half;
        to.rotation = half.conjugate() * from.rotation;
      }
    }
    deep.poses.insert(deep.poses.end(), pose.begin(), pose.end());
  }
  const SkeletalMotion out = test::valueOf(retargetByJointNames(deep, figure.skeleton));
  for (int f = 0; f < plain.frameCount(); ++f) {
    const std::vector<Affine3> a = worldOf(plain, f);
    const std::vector<Affine3> b = worldOf(out, f);
    for (std::size_t j = 0; j < a.size(); ++j) EXPECT_TRUE(a[j].isApprox(b[j], 1e-6)) << f << " " << j;
  }
  // The reverse: the motion of the plain skeleton on the skeleton with more joints.
  const SkeletalMotion back = test::valueOf(retargetByJointNames(plain, deep.skeleton));
  for (int f = 0; f < plain.frameCount(); ++f) {
    const std::vector<Affine3> a = worldOf(plain, f);
    const std::vector<Affine3> b = worldOf(back, f);
    for (std::size_t j = 0; j < a.size(); ++j) {
      const Vec3 there = b[moved[j]].translation();
      EXPECT_LT((a[j].translation() - there).norm(), 1e-6) << f << " " << j;
    }
  }
}

TEST(RetargetByJointNames, TheRestPoseOfTheClipsFileMayBeAnyPose) {
  FigureSettings settings;
  settings.armature = true;
  settings.crookedAxes = true;
  const Figure figure = makeFigure(settings);
  SkeletalMotion source = motionOf(figure, randomPoses(6));
  const auto hips = static_cast<std::size_t>(figure.skeleton.jointOf(B::kHips));
  std::vector<Joint> joints(figure.skeleton.joints().begin(), figure.skeleton.joints().end());
  for (int f = 0; f < source.frameCount(); ++f) {
    source.poses[static_cast<std::size_t>(f) * joints.size() + hips].translation += Vec3(40.0, 5.0 * f, -20.0);
  }
  for (std::size_t j = 0; j < joints.size(); ++j) joints[j].rest = source.pose(3)[j];
  source.skeleton = *Skeleton::create(std::move(joints));
  const SkeletalMotion out = test::valueOf(retargetByJointNames(source, figure.skeleton));
  for (int f = 0; f < source.frameCount(); ++f) {
    const std::vector<Affine3> a = worldOf(source, f);
    const std::vector<Affine3> b = worldOf(out, f);
    for (std::size_t j = 0; j < a.size(); ++j) EXPECT_TRUE(a[j].isApprox(b[j], 1e-6)) << f << " " << j;
  }
}

TEST(RetargetByJointNames, BonesKeepTheirOwnLengths) {
  FigureSettings tall;
  tall.thigh = 0.6;
  tall.upperArm = 0.4;
  tall.crookedAxes = true;
  FigureSettings usual = tall;
  usual.thigh = 0.4;
  usual.upperArm = 0.3;
  const Figure from = makeFigure(usual);
  const Figure to = makeFigure(tall);
  const SkeletalMotion out = test::valueOf(retargetByJointNames(motionOf(from, randomPoses(2)), to.skeleton));
  const std::vector<Affine3> world = worldOf(out, 3);
  EXPECT_NEAR(
      (positionOf(to.skeleton, world, B::kLeftUpperLeg) - positionOf(to.skeleton, world, B::kLeftLowerLeg)).norm(), 0.6,
      1e-9);
  EXPECT_NEAR(
      (positionOf(to.skeleton, world, B::kLeftUpperArm) - positionOf(to.skeleton, world, B::kLeftLowerArm)).norm(), 0.4,
      1e-9);
}

TEST(RetargetByJointNames, TooFewNamesAreRefused) {
  const Figure figure = makeFigure({});
  SkeletalMotion source = motionOf(figure, randomPoses(1));
  source.name = "run";
  std::vector<Joint> joints(figure.skeleton.joints().begin(), figure.skeleton.joints().end());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (j % 3 != 0) joints[j].name += " (2)";
  }
  const Result<SkeletalMotion> out = retargetByJointNames(source, *Skeleton::create(joints));
  ASSERT_FALSE(out);
  EXPECT_NE(out.error().message.find("moving joints match the character by name, expected at least half"),
            std::string::npos)
      << out.error().message;
}

TEST(BodyJoints, ASkeletonThatIsMadeOfThemGivesThemBack) {
  for (const char* name : {"walk", "punch_and_kick", "jumping_jacks"}) {
    SCOPED_TRACE(name);
    const auto frames = test::valueOf(readJointCsv(test::recordingsFolder() / (std::string(name) + ".csv")));
    const SkeletalMotion motion = test::valueOf(skeletalMotionOf(frames));
    const auto back = test::valueOf(bodyJointsOf(motion));
    ASSERT_EQ(back.size(), frames.size());
    double worst = 0.0;
    double worstLeg = 0.0;
    double worstTurn = 0.0;
    for (std::size_t f = 0; f < frames.size(); ++f) {
      EXPECT_EQ(back[f].time, frames[f].time);
      for (std::size_t j = 0; j < kBodyJointCount; ++j) {
        const TrackedJoint& before = frames[f].joints[j];
        const TrackedJoint& after = back[f].joints[j];
        ASSERT_EQ(after.confidence, 1.0);
        if (static_cast<BodyJoint>(j) == BodyJoint::kTorso) continue;
        const double distance = (before.position - after.position).norm();
        worst = std::max(worst, distance);
        if (static_cast<BodyJoint>(j) >= BodyJoint::kLeftHip) worstLeg = std::max(worstLeg, distance);
        if (before.orientation && f > 15) {
          worstTurn = std::max(worstTurn, before.orientation->angularDistance(*after.orientation));
        }
      }
    }
    EXPECT_LT(worstLeg, 0.005);
    EXPECT_LT(worst, 0.06) << "a trunk of fixed lengths does not shrug";
    EXPECT_LT(worstTurn, degrees(12.0));
  }
}

TEST(BodyJoints, OfASkeletonAreWhereItsJointsAre) {
  const Figure figure = makeFigure({});
  const std::vector<PersonPose> people = randomPoses(4);
  const SkeletalMotion motion = motionOf(figure, people);
  const auto frames = test::valueOf(bodyJointsOf(motion));
  const double shift =
      frames[0][BodyJoint::kHead].position.y() - positionOf(figure.skeleton, worldOf(motion, 0), B::kHead).y();
  for (std::size_t f = 0; f < people.size(); ++f) {
    const std::vector<Affine3> world = worldOf(motion, static_cast<int>(f));
    const SkeletonFrame& frame = frames[f];
    const Vec3 up(0.0, shift, 0.0);
    EXPECT_LT((frame[BodyJoint::kLeftHand].position - up - positionOf(figure.skeleton, world, B::kLeftHand)).norm(),
              1e-9);
    EXPECT_LT(
        (frame[BodyJoint::kRightKnee].position - up - positionOf(figure.skeleton, world, B::kRightLowerLeg)).norm(),
        1e-9);
    EXPECT_LT(frame[BodyJoint::kLeftElbow].orientation->angularDistance(people[f].lower[0]), degrees(0.1));
    EXPECT_LT(frame[BodyJoint::kRightFoot].orientation->angularDistance(people[f].end[3]), degrees(0.1));
    EXPECT_LT(frame[BodyJoint::kTorso].orientation->angularDistance(people[f].chest), degrees(0.1));
    EXPECT_LT(frame[BodyJoint::kHead].orientation->angularDistance(people[f].head), degrees(0.1));
  }
}

TEST(BodyJoints, UnseenJointsHoldAndNothingIsNaN) {
  const auto frames = test::valueOf(readJointCsv(test::recordingsFolder() / "punch_and_kick_noisy.csv"));
  const SkeletalMotion motion = test::valueOf(skeletalMotionOf(frames));
  for (const JointTransform& t : motion.poses) {
    ASSERT_TRUE(t.translation.allFinite() && t.rotation.coeffs().allFinite());
  }
  EXPECT_FALSE(skeletalMotionOf({}));
  EXPECT_TRUE(skeletalMotionOf({SkeletonFrame()})) << "a frame without seen joints gives a body at rest";
}

}  // namespace
}  // namespace lorica
