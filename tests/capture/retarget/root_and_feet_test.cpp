#include "capture/retarget/root_and_feet.h"

#include "capture/files/joint_csv.h"
#include "capture/retarget/bone_pose.h"
#include "capture/retarget/human_rig.h"
#include "capture/retarget/mirrored_axes.h"
#include "capture/retarget/retarget.h"
#include "capture/retarget/skeletal_retarget.h"
#include "geometry/random_numbers.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/figures.h"
#include "tests/support/allocations.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace lorica {
namespace {

using test::angleBetween;
using test::degrees;
using B = HumanBone;

Vec3 randomVector(RandomNumbers& random) {
  return {random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0)};
}

TEST(LegReach, TheAnkleReachesItsPositionAndBonesKeepTheirLengths) {
  RandomNumbers random(7);
  int reached = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 hip = randomVector(random);
    const Vec3 knee = hip + randomVector(random);
    const Vec3 ankle = knee + randomVector(random);
    const Vec3 hinge = (knee - hip).cross(randomVector(random)).normalized();
    const Vec3 wanted = hip + 1.5 * randomVector(random);
    const double thigh = (knee - hip).norm();
    const double shin = (ankle - knee).norm();
    const LegTurns turns = reachWithLeg(hip, knee, ankle, hinge, wanted);
    const Vec3 kneeAfter = hip + turns.thigh * (knee - hip);
    const Vec3 ankleAfter = kneeAfter + turns.shin * (ankle - knee);
    EXPECT_LT((ankleAfter - turns.ankle).norm(), 1e-9);
    const double away = (wanted - hip).norm();
    const double longest = 0.999 * (thigh + shin);
    const double shortest = std::abs(thigh - shin) + 1e-3 * (thigh + shin);
    if (away < longest && away > shortest) {
      EXPECT_LT((ankleAfter - wanted).norm(), 1e-9);
      ++reached;
    } else if (away > shortest) {
      EXPECT_LT(angleBetween(ankleAfter - hip, wanted - hip), 1e-6) << "as near as possible";
    }
  }
  EXPECT_GT(reached, 500);
}

TEST(LegReach, KneesBendForwardsWhereverTheyWere) {
  const Vec3 hip(0.0, 0.9, 0.0);
  for (const double bend : {-0.3, -0.01, 0.0, 0.01, 0.3, 1.5}) {
    const Vec3 knee = hip - Vec3(0.0, 0.42, 0.0);
    const Vec3 ankle = knee + 0.4 * Vec3(0.0, -std::cos(bend), -std::sin(bend));  // below 0 is backwards
    const LegTurns turns = reachWithLeg(hip, knee, ankle, Vec3::UnitX(), Vec3(0.02, 0.2, 0.05));
    const Vec3 thigh = turns.thigh * (knee - hip);
    const Vec3 shin = turns.shin * (ankle - knee);
    EXPECT_GT(thigh.cross(shin).dot(turns.thigh * Vec3::UnitX()), 0.01) << bend;
  }
}

TEST(LegReach, AnAnkleThatIsThereStays) {
  RandomNumbers random(8);
  for (int i = 0; i < 100; ++i) {
    const Vec3 hip(0.0, 0.9, 0.0);
    const double bend = random.between(0.2, 2.0);
    const Vec3 knee = hip - Vec3(0.0, 0.42, 0.0);
    const Vec3 ankle = knee + 0.4 * Vec3(0.0, -std::cos(bend), -std::sin(bend));
    const LegTurns turns = reachWithLeg(hip, knee, ankle, Vec3::UnitX(), ankle);
    EXPECT_LT(turns.thigh.angularDistance(Quat::Identity()), 1e-6);
    EXPECT_LT(turns.shin.angularDistance(Quat::Identity()), 1e-6);
  }
}

TEST(LegReach, TheHipComesDownByWhatIsNeeded) {
  const Vec3 hip(0.0, 0.9, 0.0);
  const Vec3 knee(0.0, 0.5, 0.1);
  const Vec3 ankle(0.0, 0.1, 0.0);
  const double length = (knee - hip).norm() + (ankle - knee).norm();
  const Vec3 wanted(0.3, 0.0, 0.2);
  const double drop = dropToReach(hip, knee, ankle, wanted);
  EXPECT_NEAR((hip - Vec3(0.0, drop, 0.0) - wanted).norm(), 0.999 * length, 1e-9);
  EXPECT_EQ(dropToReach(hip, knee, ankle, Vec3(0.0, 0.2, 0.1)), 0.0);
  EXPECT_EQ(dropToReach(hip, knee, ankle, Vec3(0.0, 3.0, 0.0)), 0.0) << "lowering the hip would not help";
}

/// A mannequin of other proportions.
Skeleton mannequinWith(double thigh, double shin, double hipWidth, double size) {
  const Skeleton plain = makeMannequin().skeleton;
  std::vector<Joint> joints(plain.joints().begin(), plain.joints().end());
  for (Joint& joint : joints) {
    Vec3& offset = joint.rest.translation;
    if (joint.bone == B::kLeftLowerLeg || joint.bone == B::kRightLowerLeg) offset *= thigh;
    if (joint.bone == B::kLeftFoot || joint.bone == B::kRightFoot) offset *= shin;
    if (joint.bone == B::kLeftUpperLeg || joint.bone == B::kRightUpperLeg) offset.x() *= hipWidth;
    offset *= size;
  }
  return *Skeleton::create(std::move(joints));
}

struct Live {
  double slide = 0.0;  ///< [m]
  double step = 0.0;   ///< of an ankle, beyond that of the person, from one frame to the next [m]
  double kneeBackwards = 0.0;
  int stances = 0;
};

/// Stances are detected in the recording: the ankle moves slower than 0.2 m/s, within 5 cm of its lowest position.
Live play(const std::string& recording, const Skeleton& skeleton, bool plantFeet) {
  const auto frames = readJointCsv(test::recordingsFolder() / recording);
  EXPECT_TRUE(frames) << frames.error().message;
  const RetargetRig rig = *RetargetRig::create(skeleton);
  Retargeter retargeter = *Retargeter::create(skeleton, {.hold = {}, .plantFeet = plantFeet});
  Pose pose(skeleton.joints().size());
  Live worst;
  std::array<double, 2> lowest = {1e9, 1e9};
  for (const SkeletonFrame& frame : *frames) {
    for (std::size_t side = 0; side < 2; ++side) {
      const TrackedJoint& foot = frame[limbs()[kFirstLeg + side].endJoint];
      lowest[side] = std::min(lowest[side], foot.position.y());
    }
  }
  std::array<bool, 2> stands{};
  std::array<Vec3, 2> start, startShown, before, beforeShown;
  for (std::size_t f = 0; f < frames->size(); ++f) {
    retargeter.apply((*frames)[f], pose);
    const std::vector<Affine3> world = test::worldOf(skeleton, pose);
    const auto at = [&](B bone) -> Vec3 { return world[skeleton.jointOf(bone)].translation(); };
    for (std::size_t side = 0; side < 2; ++side) {
      const LimbBones& leg = limbs()[kFirstLeg + side];
      const auto thighJoint = static_cast<std::size_t>(skeleton.jointOf(leg.upper));
      const Mat3 turn = world[thighJoint].linear();
      const Vec3 hinge = turn * (rig.tposeFromJoint[thighJoint].conjugate() * Vec3::UnitX());
      const Vec3 bend = (at(leg.lower) - at(leg.upper)).normalized().cross((at(leg.end) - at(leg.lower)).normalized());
      worst.kneeBackwards = std::max(worst.kneeBackwards, -bend.dot(hinge));
      const Vec3 foot = (*frames)[f][leg.endJoint].position;
      const Vec3 shown = at(leg.end);
      if (f > 0) {
        const double step = (*frames)[f].time - (*frames)[f - 1].time;
        const bool still = (foot - before[side]).norm() < 0.2 * step && foot.y() < lowest[side] + 0.05;
        if (still && !stands[side]) {
          start[side] = before[side];
          startShown[side] = beforeShown[side];
          ++worst.stances;
        }
        stands[side] = still;
        const auto level = [](const Vec3& v) { return std::hypot(v.x(), v.z()); };
        const double ratio = retargeter.legRatio();
        if (still && (*frames)[f].time > (*frames)[0].time + 1.5) {  // the ratio is still being estimated before
          worst.slide = std::max(worst.slide, level(shown - startShown[side]) - ratio * level(foot - start[side]));
        }
        worst.step = std::max(worst.step, level(shown - beforeShown[side]) - 1.3 * ratio * level(foot - before[side]));
      }
      before[side] = foot;
      beforeShown[side] = shown;
    }
  }
  return worst;
}

class LiveFeet : public ::testing::TestWithParam<const char*> {};

TEST_P(LiveFeet, StandStillOnAnyCharacter) {
  const std::string file = std::string(GetParam()) + ".csv";
  double slideWithout = 0.0;
  for (const Skeleton& skeleton : {mannequinWith(1.0, 1.0, 1.0, 1.0), mannequinWith(0.75, 1.2, 1.0, 1.0),
                                   mannequinWith(1.2, 0.8, 1.4, 1.0), mannequinWith(1.1, 1.0, 1.0, 0.4)}) {
    const Live live = play(file, skeleton, true);
    const Live free = play(file, skeleton, false);
    EXPECT_GE(live.stances, 2);
    EXPECT_LT(live.slide, 0.01);
    EXPECT_LT(live.step, free.step + 0.02) << "a foot jumps";
    EXPECT_LT(live.kneeBackwards, 1e-3);
    slideWithout = std::max(slideWithout, free.slide);
  }
  EXPECT_GT(slideWithout, 0.01) << "the test must be able to fail";
}

INSTANTIATE_TEST_SUITE_P(All, LiveFeet,
                         ::testing::Values("walk", "wave", "jumping_jacks", "squat_and_reach", "punch_and_kick",
                                           "turn_around"),
                         [](const auto& chosen) { return std::string(chosen.param); });

TEST(FootLock, TheSameFramesGiveTheSameBits) {
  const auto frames = test::valueOf(readJointCsv(test::recordingsFolder() / "punch_and_kick_noisy.csv"));
  const Skeleton skeleton = mannequinWith(1.2, 0.8, 1.4, 1.0);
  Retargeter a = *Retargeter::create(skeleton);
  Retargeter b = *Retargeter::create(skeleton);
  Pose poseA(skeleton.joints().size());
  Pose poseB(skeleton.joints().size());
  for (const SkeletonFrame& frame : frames) {
    a.apply(frame, poseA);
    b.apply(frame, poseB);
    for (std::size_t j = 0; j < poseA.size(); ++j) {
      ASSERT_EQ(poseA[j].rotation.coeffs(), poseB[j].rotation.coeffs());
      ASSERT_EQ(poseA[j].translation, poseB[j].translation);
      ASSERT_TRUE(poseA[j].rotation.coeffs().allFinite() && poseA[j].translation.allFinite());
    }
  }
}

TEST(FootLock, APlayedFrameAllocatesNothing) {
  const auto frames = test::valueOf(readJointCsv(test::recordingsFolder() / "walk_noisy.csv"));
  const Skeleton skeleton = mannequinWith(1.2, 0.8, 1.4, 1.0);
  Retargeter retargeter = *Retargeter::create(skeleton);
  Pose pose(skeleton.joints().size());
  const test::AllocationWatch watch;
  for (const SkeletonFrame& frame : frames) retargeter.apply(frame, pose);
  EXPECT_EQ(watch.largest(), 0U);
}

TEST(FootLock, TeleportsAndPausesBreakNothing) {
  auto frames = test::valueOf(readJointCsv(test::recordingsFolder() / "walk.csv"));
  const Skeleton skeleton = mannequinWith(1.2, 0.8, 1.4, 1.0);
  Retargeter retargeter = *Retargeter::create(skeleton);
  Pose pose(skeleton.joints().size());
  RandomNumbers random(3);
  double time = 0.0;
  for (SkeletonFrame& frame : frames) {
    time += random.unit() < 0.1 ? -0.5 : random.unit() < 0.1 ? 30.0 : 0.033;
    frame.time = time;
    const Vec3 jump = random.unit() < 0.1 ? Vec3(5.0 * randomVector(random)) : Vec3::Zero();
    for (TrackedJoint& joint : frame.joints) joint.position += jump;
    retargeter.apply(frame, pose);
    for (const JointTransform& t : pose) ASSERT_TRUE(t.rotation.coeffs().allFinite() && t.translation.allFinite());
  }
}

// Heads whose end is known are transferred by where they look, not by how they were bound.

/// @param bow  of the head at rest, about +X [rad] @param end  in the frame of the head [m]
Skeleton figureWithHead(double bow, const Vec3& end) {
  const Skeleton plain = test::makeFigure({}).skeleton;
  std::vector<Joint> joints(plain.joints().begin(), plain.joints().end());
  const JointIndex head = plain.jointOf(HumanBone::kHead);
  joints[head].rest.rotation = Quat(Eigen::AngleAxisd(bow, Vec3::UnitX()));
  Joint top;
  top.name = "HeadTop_End";
  top.parent = head;
  top.rest.translation = end;
  joints.push_back(top);
  return Skeleton::create(std::move(joints)).value();
}

/// By how much a plain figure's head looks up or down when another one's head is held at an angle [degrees].
double pitchOnPlain(const Skeleton& skeleton, double angle) {
  Pose pose = restPose(skeleton);
  pose[skeleton.jointOf(HumanBone::kHead)].rotation = Quat(Eigen::AngleAxisd(angle, Vec3::UnitX()));
  const SkeletalMotion motion{"nod", skeleton, {0.0}, pose};
  const Skeleton plain = test::makeFigure({}).skeleton;
  const SkeletalMotion performed = retargetMotion(motion, plain).value();
  const Affine3 head = test::worldOf(plain, Pose(performed.poses))[plain.jointOf(HumanBone::kHead)];
  const Vec3 ahead = head.linear() * Vec3::UnitZ();
  return std::atan2(-ahead.y(), ahead.z()) * 180.0 / std::numbers::pi;
}

TEST(BowedHead, ALevelLookStaysLevel) {
  constexpr double kBow = 0.35;
  const Vec3 above(0.0, 0.2, 0.0);
  for (const double bow : {0.0, kBow, -kBow}) {
    const Skeleton skeleton = figureWithHead(bow, above);
    EXPECT_NEAR(pitchOnPlain(skeleton, 0.0), 0.0, 0.5) << bow;
    EXPECT_NEAR(pitchOnPlain(skeleton, 0.3), 17.2, 0.5) << bow;
  }
}

TEST(BowedHead, AnEndThatIsNotStraightAboveSaysNothing) {
  // As Mixamo's: the head is bound level, and its top is 20 degrees ahead.
  EXPECT_NEAR(pitchOnPlain(figureWithHead(0.0, Vec3(0.0, 0.185, 0.066)), 0.0), 0.0, 0.1);
}

// Skeletons below a negative scale, which mirrors the axes of all joints.

Character characterOf(const Skeleton& skeleton) {
  Character character;
  character.skeleton = skeleton;
  character.influenceBegin = {0};
  character.height = 1.6;
  for (const Affine3& world : test::worldOf(skeleton, restPose(skeleton))) {
    character.jointFromModel.push_back(world.inverse());
  }
  return character;
}

/// The same joints below one with this scale.
Skeleton belowScale(const Skeleton& skeleton, const Vec3& scale) {
  std::vector<Joint> joints(1);
  joints[0].name = "mirror";
  joints[0].rest.scale = scale;
  for (Joint joint : skeleton.joints()) {
    ++joint.parent;
    joints.push_back(joint);
  }
  return Skeleton::create(std::move(joints)).value();
}

Skeleton figure() {
  test::FigureSettings settings;
  settings.crookedAxes = true;
  settings.armsDown = degrees(40.0);
  return test::makeFigure(settings).skeleton;
}

SkeletalMotion walk() {
  return skeletalMotionOf(readJointCsv(test::recordingsFolder() / "walk.csv").value()).value();
}

/// Largest distance of a bone from the one on the other side of a plain figure [m].
double distance(const SkeletalMotion& mirrored, const SkeletalMotion& plain, bool otherSides) {
  double largest = 0.0;
  for (int f = 0; f < plain.frameCount(); f += 10) {
    const std::vector<Affine3> a =
        test::worldOf(mirrored.skeleton, Pose(mirrored.pose(f).begin(), mirrored.pose(f).end()));
    const std::vector<Affine3> b = test::worldOf(plain.skeleton, Pose(plain.pose(f).begin(), plain.pose(f).end()));
    for (const Joint& joint : plain.skeleton.joints()) {
      const HumanBone bone = *joint.bone;
      const JointIndex one = mirrored.skeleton.jointOf(otherSides ? otherSide(bone) : bone);
      largest = std::max(largest, (a[one].translation() - b[plain.skeleton.jointOf(bone)].translation()).norm());
    }
  }
  return largest;
}

TEST(MirroredAxes, AMirroredBodyMovesLikeItself) {
  const SkeletalMotion motion = walk();
  const Character plain = characterOf(figure());
  const SkeletalMotion expected = retargetMotion(motion, plain).value();
  for (const Vec3& scale : {Vec3(-1.0, 1.0, 1.0), Vec3(1.0, 1.0, -1.0), Vec3(-1.0, 1.0, -1.0)}) {
    const Character mirrored = characterOf(belowScale(plain.skeleton, scale));
    const Result<SkeletalMotion> performed = retargetMotion(motion, mirrored);
    ASSERT_TRUE(performed) << performed.error().message;
    const bool otherSides = scale.prod() < 0.0;  // left and right were named before it was mirrored
    EXPECT_LT(distance(*performed, expected, otherSides), 1e-6) << scale.transpose();
    // And back, as the source of a motion.
    const Result<SkeletalMotion> back = retargetMotion(*performed, plain);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_LT(distance(*back, expected, false), 0.01) << scale.transpose();
  }
}

TEST(MirroredAxes, BonesThatAreSentAreThoseOfThePlainBody) {
  const Skeleton plain = figure();
  const Skeleton mirrored = belowScale(plain, Vec3(-1.0, 1.0, 1.0));
  Pose pose = restPose(mirrored);
  const JointIndex arm = mirrored.jointOf(HumanBone::kLeftUpperArm);
  pose[arm].rotation = pose[arm].rotation * Quat(Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, 3.0).normalized()));
  const BonePose sent = BonePoseReader::create(mirrored).value().read(pose);
  const std::vector<Affine3> world = test::worldOf(mirrored, pose);
  // Positions that follow from what is sent are those of the joints; what was named left is on the right.
  const WorldBones bones = worldOf(sent);
  for (const HumanBone bone : {HumanBone::kLeftHand, HumanBone::kRightHand, HumanBone::kLeftFoot, HumanBone::kHead}) {
    const Vec3 expected = world[mirrored.jointOf(otherSide(bone))].translation();
    EXPECT_LT((bones.position[static_cast<std::size_t>(bone)] - expected).norm(), 1e-9) << nameOf(bone);
  }
}

TEST(MirroredAxes, WithoutNegativeScalesNothingChanges) {
  const Skeleton plain = figure();
  EXPECT_FALSE(MirroredAxes(plain).any());
}

}  // namespace
}  // namespace lorica
