#include "skinning/humanoid/joint_limits.h"

#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "skinning/mannequin/mannequin_skeleton.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

namespace lorica {
namespace {

using enum HumanBone;

constexpr double kDegree = std::numbers::pi / 180.0;

std::vector<HumanBone> allBones() {
  std::vector<HumanBone> bones;
  for (int i = 0; i < kHumanBoneCount; ++i) bones.push_back(static_cast<HumanBone>(i));
  return bones;
}

/// Where a bone ends up that pointed along `rest` in T-pose, its joint turned by these angles.
Vec3 turned(HumanBone bone, const JointAngles& angles, const Vec3& rest) {
  return rotationOf(jointRange(bone), angles) * rest;
}

const Quat& rotationIn(const Skeleton& skeleton, const Pose& pose, HumanBone bone) {
  return pose[static_cast<std::size_t>(skeleton.jointOf(bone))].rotation;
}

double angleBetween(const Quat& a, const Quat& b) {
  return a.angularDistance(b);
}

TEST(RandomNumbers, AreSplitMix64) {
  // The published first outputs for seed 0.
  RandomNumbers random(0);
  EXPECT_EQ(random.bits(), 0xe220a8397b1dcdafu);
  EXPECT_EQ(random.bits(), 0x6e789e6aa1b965f4u);
  EXPECT_EQ(random.bits(), 0x06c45d188009454fu);
  double least = 1.0, most = 0.0, sum = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const double value = random.between(2.0, 5.0);
    least = std::min(least, (value - 2.0) / 3.0);
    most = std::max(most, (value - 2.0) / 3.0);
    sum += value / 10000.0;
  }
  EXPECT_GE(least, 0.0);
  EXPECT_LT(least, 0.01);
  EXPECT_LT(most, 1.0);
  EXPECT_GT(most, 0.99);
  EXPECT_NEAR(sum, 3.5, 0.03);
}

TEST(JointLimits, AxesAreARightHandedFrameAndRangesHoldTheTPose) {
  for (const HumanBone bone : allBones()) {
    const JointRange& range = jointRange(bone);
    Mat3 axes;
    axes << range.twistAxis, range.firstAxis, range.secondAxis;
    EXPECT_TRUE((axes * axes.transpose()).isIdentity(1e-14)) << nameOf(bone);
    EXPECT_NEAR(axes.determinant(), 1.0, 1e-14) << nameOf(bone);
    for (const AngleRange& angle : {range.twist, range.first, range.second}) {
      EXPECT_LE(angle.least, 0.0) << nameOf(bone);
      EXPECT_GE(angle.most, 0.0) << nameOf(bone);
      EXPECT_LT(angle.most - angle.least, 2.0 * std::numbers::pi + 1e-9) << nameOf(bone);
    }
    EXPECT_GT(range.first.most - range.first.least + range.twist.most, 0.0) << nameOf(bone) << " does not move";
  }
}

TEST(JointLimits, MovementsGoTheWayAnatomySays) {
  const Vec3 up = Vec3::UnitY(), forward = Vec3::UnitZ(), left = Vec3::UnitX();
  const auto most = [](HumanBone bone) { return JointAngles{0.0, jointRange(bone).first.most, 0.0}; };
  const auto least = [](HumanBone bone) { return JointAngles{0.0, jointRange(bone).first.least, 0.0}; };
  const auto secondMost = [](HumanBone bone) { return JointAngles{0.0, 0.0, jointRange(bone).second.most}; };
  const auto secondLeast = [](HumanBone bone) { return JointAngles{0.0, 0.0, jointRange(bone).second.least}; };
  const auto twistMost = [](HumanBone bone) { return JointAngles{jointRange(bone).twist.most, 0.0, 0.0}; };
  const auto twistLeast = [](HumanBone bone) { return JointAngles{jointRange(bone).twist.least, 0.0, 0.0}; };

  // Knee and elbow bend one way: heel to the back, hand to the front and on to the shoulder.
  EXPECT_LT(turned(kLeftLowerLeg, most(kLeftLowerLeg), -up).z(), -0.7);
  EXPECT_GT(turned(kLeftLowerLeg, most(kLeftLowerLeg), -up).y(), 0.7);
  EXPECT_EQ(jointRange(kLeftLowerLeg).first.least, 0.0);
  EXPECT_EQ(jointRange(kLeftLowerLeg).second.most - jointRange(kLeftLowerLeg).second.least, 0.0);
  EXPECT_GT(turned(kLeftLowerArm, {0.0, 90.0 * kDegree, 0.0}, left).dot(forward), 0.999999);
  EXPECT_NEAR(turned(kLeftLowerArm, most(kLeftLowerArm), left).x(), std::cos(150.0 * kDegree), 1e-12);
  EXPECT_EQ(jointRange(kLeftLowerArm).first.least, 0.0);

  // Thigh: 120 degrees forward is above the horizontal; back 30; out 45.
  EXPECT_NEAR(turned(kLeftUpperLeg, least(kLeftUpperLeg), -up).y(), 0.5, 1e-12);
  EXPECT_GT(turned(kLeftUpperLeg, least(kLeftUpperLeg), -up).z(), 0.8);
  EXPECT_NEAR(turned(kLeftUpperLeg, most(kLeftUpperLeg), -up).z(), -0.5, 1e-12);
  EXPECT_NEAR(turned(kLeftUpperLeg, secondLeast(kLeftUpperLeg), -up).x(), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(turned(kRightUpperLeg, secondLeast(kRightUpperLeg), -up).x(), -std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(turned(kLeftUpperLeg, secondMost(kLeftUpperLeg), -up).x(), -0.5, 1e-12);

  // Foot: toes up 20, down 50; its sole turns in (to the right of the left foot) further than out.
  EXPECT_NEAR(turned(kLeftFoot, least(kLeftFoot), forward).y(), std::sin(20.0 * kDegree), 1e-12);
  EXPECT_NEAR(turned(kLeftFoot, most(kLeftFoot), forward).y(), -std::sin(50.0 * kDegree), 1e-12);
  EXPECT_NEAR(turned(kLeftFoot, twistLeast(kLeftFoot), -up).x(), -std::sin(35.0 * kDegree), 1e-12);
  EXPECT_GT(turned(kLeftToes, least(kLeftToes), forward).y(), 0.9);

  // Arm with collarbone: straight up, hanging, 135 forward.
  EXPECT_GT(
      (rotationOf(jointRange(kLeftShoulder), most(kLeftShoulder)) * turned(kLeftUpperArm, most(kLeftUpperArm), left))
          .dot(up),
      0.999999);
  EXPECT_GT(turned(kLeftUpperArm, least(kLeftUpperArm), left).dot(-up), 0.999999);
  const Vec3 across = rotationOf(jointRange(kLeftShoulder), secondMost(kLeftShoulder)) *
                      turned(kLeftUpperArm, secondMost(kLeftUpperArm), left);
  EXPECT_NEAR(across.x(), std::cos(135.0 * kDegree), 1e-12);
  EXPECT_NEAR(across.z(), std::sin(135.0 * kDegree), 1e-12);
  // A forearm bent forward goes up with lateral rotation (90) and down with medial (70), on both sides.
  for (const HumanBone arm : {kLeftUpperArm, kRightUpperArm}) {
    EXPECT_GT(turned(arm, twistLeast(arm), forward).dot(up), 0.999999);
    EXPECT_NEAR(turned(arm, twistMost(arm), forward).y(), -std::sin(70.0 * kDegree), 1e-12);
  }

  // Supination turns the palm, which looks down, to the front and then up: 160 degrees by forearm and hand together.
  const Quat supine = rotationOf(jointRange(kLeftLowerArm), twistLeast(kLeftLowerArm)) *
                      rotationOf(jointRange(kLeftHand), twistLeast(kLeftHand));
  EXPECT_NEAR((supine * -up).y(), std::cos(20.0 * kDegree), 1e-12);
  EXPECT_GT((rotationOf(jointRange(kLeftHand), twistLeast(kLeftHand)) * -up).z(), 0.9);
  EXPECT_NEAR(turned(kLeftHand, least(kLeftHand), left).y(), -std::sin(80.0 * kDegree), 1e-12);
  EXPECT_NEAR(turned(kLeftHand, secondMost(kLeftHand), left).z(), std::sin(20.0 * kDegree), 1e-12);

  // A fist: fingers roll down and back under the palm. Spread: index to the front, little finger to the back.
  const Vec3 fingertip = rotationOf(jointRange(kLeftIndexProximal), {0.0, 90.0 * kDegree, 0.0}) *
                         turned(kLeftIndexIntermediate, {0.0, 90.0 * kDegree, 0.0}, left);
  EXPECT_GT(fingertip.dot(-left), 0.999999);
  EXPECT_GT(turned(kLeftIndexProximal, secondLeast(kLeftIndexProximal), left).z(), 0.3);
  EXPECT_LT(turned(kLeftLittleProximal, secondMost(kLeftLittleProximal), left).z(), -0.3);
  // The thumb leaves the palm downward and bends to the fingers.
  const Vec3 thumb = Vec3(1, 0, 1).normalized();
  EXPECT_LT(turned(kLeftThumbMetacarpal, most(kLeftThumbMetacarpal), thumb).y(), -0.9);
  EXPECT_LT(turned(kLeftThumbMetacarpal, secondMost(kLeftThumbMetacarpal), thumb).z(), thumb.z());
  EXPECT_LT(turned(kLeftThumbDistal, most(kLeftThumbDistal), thumb).y(), -0.5);
  EXPECT_LT(turned(kLeftThumbDistal, most(kLeftThumbDistal), thumb).z(), 0.0);

  // Trunk: chin to the chest, all of the spine 80 forward.
  EXPECT_GT(turned(kHead, most(kHead), up).z(), 0.3);
  EXPECT_NEAR(jointRange(kSpine).first.most + jointRange(kChest).first.most + jointRange(kUpperChest).first.most,
              80.0 * kDegree, 1e-12);
  EXPECT_GT(turned(kSpine, most(kSpine), up).z(), 0.4);
}

TEST(JointLimits, RotationsEqualThoseBySines) {
  RandomNumbers random(3);
  for (int i = 0; i < 2000; ++i) {
    const JointRange& range = jointRange(allBones()[static_cast<std::size_t>(i % kHumanBoneCount)]);
    const JointAngles angles{random.between(-3.1, 3.1), random.between(-2.2, 2.2), random.between(-2.2, 2.2)};
    const Vec3 swing = angles.first * range.firstAxis + angles.second * range.secondAxis;
    const Quat twistBySines(Eigen::AngleAxisd(angles.twist, range.twistAxis));
    const Quat swingBySines(Eigen::AngleAxisd(swing.norm(), swing.normalized()));
    const Quat expected = range.twistAtParent ? twistBySines * swingBySines : swingBySines * twistBySines;
    const Quat found = rotationOf(range, angles);
    EXPECT_LT((found.coeffs() - expected.coeffs()).norm(), 1e-14);
  }
}

TEST(JointLimits, AnglesAreFoundAgain) {
  RandomNumbers random(4);
  for (int i = 0; i < 2000; ++i) {
    const JointRange& range = jointRange(allBones()[static_cast<std::size_t>(i % kHumanBoneCount)]);
    const JointAngles angles{random.between(-3.1, 3.1), random.between(-2.2, 2.2), random.between(-2.2, 2.2)};
    // Both quaternions of a turn are one turn.
    Quat rotation = rotationOf(range, angles);
    if (i % 2 == 1) rotation.coeffs() *= -1.0;
    const JointAngles found = anglesOf(range, rotation);
    if (std::hypot(angles.first, angles.second) > 3.1) continue;
    EXPECT_NEAR(found.twist, angles.twist, 1e-8);
    EXPECT_NEAR(found.first, angles.first, 1e-8);
    EXPECT_NEAR(found.second, angles.second, 1e-8);
  }
}

TEST(JointLimits, AnEndOfARangeIsWithinAndADegreeMoreIsNot) {
  const Skeleton skeleton = makeMannequinSkeleton();
  EXPECT_TRUE(withinLimits(skeleton, restPose(skeleton)));
  for (const HumanBone bone : allBones()) {
    if (bone == kHips) continue;  // turns all the way round
    const JointRange& range = jointRange(bone);
    const auto isWithin = [&](const JointAngles& angles) {
      Pose pose = restPose(skeleton);
      pose[static_cast<std::size_t>(skeleton.jointOf(bone))].rotation = rotationOf(range, angles);
      return withinLimits(skeleton, pose);
    };
    EXPECT_TRUE(isWithin({range.twist.most, 0.0, 0.0})) << nameOf(bone);
    EXPECT_TRUE(isWithin({range.twist.least, 0.0, 0.0})) << nameOf(bone);
    EXPECT_TRUE(isWithin({0.0, range.first.most, 0.0})) << nameOf(bone);
    EXPECT_TRUE(isWithin({0.0, range.first.least, 0.0})) << nameOf(bone);
    EXPECT_TRUE(isWithin({0.0, 0.0, range.second.most})) << nameOf(bone);
    EXPECT_TRUE(isWithin({0.0, 0.0, range.second.least})) << nameOf(bone);
    EXPECT_FALSE(isWithin({range.twist.most + kDegree, 0.0, 0.0})) << nameOf(bone);
    EXPECT_FALSE(isWithin({range.twist.least - kDegree, 0.0, 0.0})) << nameOf(bone);
    EXPECT_FALSE(isWithin({0.0, range.first.most + kDegree, 0.0})) << nameOf(bone);
    EXPECT_FALSE(isWithin({0.0, range.first.least - kDegree, 0.0})) << nameOf(bone);
    EXPECT_FALSE(isWithin({0.0, 0.0, range.second.most + kDegree})) << nameOf(bone);
    EXPECT_FALSE(isWithin({0.0, 0.0, range.second.least - kDegree})) << nameOf(bone);
    // Not both ends at a time.
    if (range.first.most * range.second.most > 0.0) {
      EXPECT_FALSE(isWithin({0.0, 0.8 * range.first.most, 0.8 * range.second.most})) << nameOf(bone);
      EXPECT_TRUE(isWithin({0.0, 0.7 * range.first.most, 0.7 * range.second.most})) << nameOf(bone);
    }
  }
}

/// What angles random poses have, bone by bone.
struct Seen {
  JointAngles least{9.0, 9.0, 9.0}, most{-9.0, -9.0, -9.0};
};

TEST(RandomPose, StaysWithinLimitsAndReachesTheirEnds) {
  const Skeleton skeleton = makeMannequinSkeleton();
  RandomNumbers random(5);
  std::map<HumanBone, Seen> seenOf;
  for (int i = 0; i < 4000; ++i) {
    const Pose pose = randomPoseWithinLimits(skeleton, random);
    ASSERT_TRUE(withinLimits(skeleton, pose)) << i;
    for (const HumanBone bone : allBones()) {
      const JointAngles angles = anglesOf(jointRange(bone), rotationIn(skeleton, pose, bone));
      Seen& seen = seenOf[bone];
      for (double JointAngles::*angle : {&JointAngles::twist, &JointAngles::first, &JointAngles::second}) {
        seen.least.*angle = std::min(seen.least.*angle, angles.*angle);
        seen.most.*angle = std::max(seen.most.*angle, angles.*angle);
      }
    }
  }
  for (const HumanBone bone : allBones()) {
    const JointRange& range = jointRange(bone);
    const Seen& seen = seenOf[bone];
    const auto expectReached = [&](const AngleRange& allowed, double least, double most) {
      const double close = 0.06 * (allowed.most - allowed.least) + 1e-6;
      EXPECT_NEAR(least, allowed.least, close) << nameOf(bone);
      EXPECT_NEAR(most, allowed.most, close) << nameOf(bone);
    };
    expectReached(range.twist, seen.least.twist, seen.most.twist);
    expectReached(range.first, seen.least.first, seen.most.first);
    expectReached(range.second, seen.least.second, seen.most.second);
  }
}

/// Without the swings and twists of the code: where elbows, knees and heads are, by forward kinematics.
TEST(RandomPose, PutsBonesWhereBodiesCan) {
  const Skeleton skeleton = makeMannequinSkeleton();
  RandomNumbers random(6);
  std::vector<Affine3> world(static_cast<std::size_t>(skeleton.jointCount()));
  const auto at = [&](HumanBone bone) -> const Affine3& {
    return world[static_cast<std::size_t>(skeleton.jointOf(bone))];
  };
  for (int i = 0; i < 2000; ++i) {
    const Pose pose = randomPoseWithinLimits(skeleton, random);
    computeWorldFromJoint(skeleton, pose, world);
    EXPECT_TRUE(at(kHips).translation().isApprox(mannequinJoint(kHips)));
    EXPECT_GT((at(kHips).linear() * Vec3::UnitY()).y(), 0.999999);
    struct Limb {
      HumanBone upper, lower, end;
      double mostDegrees;
    };
    for (const Limb& limb :
         {Limb{kLeftUpperArm, kLeftLowerArm, kLeftHand, 150.0}, Limb{kRightUpperArm, kRightLowerArm, kRightHand, 150.0},
          Limb{kLeftUpperLeg, kLeftLowerLeg, kLeftFoot, 135.0},
          Limb{kRightUpperLeg, kRightLowerLeg, kRightFoot, 135.0}}) {
      const Vec3 joint = at(limb.lower).translation();
      const Vec3 along = (joint - at(limb.upper).translation()).normalized();
      const Vec3 beyond = (at(limb.end).translation() - joint).normalized();
      // The bones of a straight limb are not quite in line: 5 degrees in the leg.
      EXPECT_LT(std::acos(std::clamp(along.dot(beyond), -1.0, 1.0)), (limb.mostDegrees + 6.0) * kDegree);
      const bool isArm = limb.end == kLeftHand || limb.end == kRightHand;
      const Vec3 fore = at(limb.upper).linear() * Vec3::UnitZ();
      const Vec3 aside = at(limb.upper).linear() * (isArm ? Vec3::UnitY() : Vec3::UnitX());
      EXPECT_GT((isArm ? 1.0 : -1.0) * fore.dot(beyond), -0.1) << nameOf(limb.lower) << " bent the wrong way";
      EXPECT_LT(std::abs(aside.dot(beyond)), 0.05) << nameOf(limb.lower) << " bent sideways";
      // Lengths stay.
      EXPECT_NEAR((at(limb.end).translation() - joint).norm(),
                  (mannequinJoint(limb.end) - mannequinJoint(limb.lower)).norm(), 1e-12);
    }
    // The face does not look back over the shoulders' plane by more than neck and spine turn together.
    const Vec3 chestFront = at(kUpperChest).linear() * Vec3::UnitZ();
    EXPECT_GT((at(kHead).linear() * Vec3::UnitZ()).dot(chestFront), std::cos(100.0 * kDegree));
  }
}

TEST(RandomPose, SameSeedSamePoseTwoSeedsTwoPoses) {
  const Skeleton skeleton = makeMannequinSkeleton();
  RandomNumbers first(7), again(7), other(8);
  const Pose a = randomPoseWithinLimits(skeleton, first);
  const Pose b = randomPoseWithinLimits(skeleton, again);
  const Pose c = randomPoseWithinLimits(skeleton, other);
  const Pose next = randomPoseWithinLimits(skeleton, first);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].rotation.coeffs(), b[i].rotation.coeffs());
    EXPECT_GT(angleBetween(a[i].rotation, c[i].rotation), 0.0) << i;
    EXPECT_GT(angleBetween(a[i].rotation, next[i].rotation), 0.0) << i;
  }
}

TEST(RandomPose, HasTheSameBitsWithEveryCompiler) {
  const Skeleton skeleton = makeMannequinSkeleton();
  RandomNumbers random(1);
  std::string bytes;
  for (int i = 0; i < 100; ++i) {
    for (const JointTransform& joint : randomPoseWithinLimits(skeleton, random)) {
      for (const double value : joint.rotation.coeffs()) appendLittleEndian(value, bytes);
    }
  }
  EXPECT_EQ(hexDigits(contentHash(bytes)), "c38644bb9bb9e9a5");
}

TEST(JointLimits, LeftMirrorsRight) {
  const Skeleton skeleton = makeMannequinSkeleton();
  RandomNumbers random(9);
  std::vector<Affine3> world(static_cast<std::size_t>(skeleton.jointCount())), mirroredWorld = world;
  for (int i = 0; i < 200; ++i) {
    const Pose pose = randomPoseWithinLimits(skeleton, random);
    // The mirror image of a turn keeps the x of its axis and reverses y and z.
    Pose reflected = pose;
    for (const HumanBone bone : allBones()) {
      const Quat& q = rotationIn(skeleton, pose, bone);
      reflected[static_cast<std::size_t>(skeleton.jointOf(mirrored(bone)))].rotation =
          Quat(q.w(), q.x(), -q.y(), -q.z());
    }
    EXPECT_TRUE(withinLimits(skeleton, reflected));
    computeWorldFromJoint(skeleton, pose, world);
    computeWorldFromJoint(skeleton, reflected, mirroredWorld);
    for (const HumanBone bone : allBones()) {
      const Vec3 p = world[static_cast<std::size_t>(skeleton.jointOf(bone))].translation();
      const Vec3 q = mirroredWorld[static_cast<std::size_t>(skeleton.jointOf(mirrored(bone)))].translation();
      EXPECT_LT((Vec3(-p.x(), p.y(), p.z()) - q).norm(), 1e-12) << nameOf(bone);
    }
  }
  for (const HumanBone bone : allBones()) {
    EXPECT_EQ(jointRange(bone).first.most, jointRange(mirrored(bone)).first.most);
    EXPECT_EQ(jointRange(bone).second.least, jointRange(mirrored(bone)).second.least);
    EXPECT_EQ(jointRange(bone).twist.least, jointRange(mirrored(bone)).twist.least);
  }
}

TEST(RandomPose, LeavesOtherJointsAndMissingBonesAlone) {
  std::vector<Joint> joints(4);
  joints[0].name = "armature";
  joints[0].rest.translation = Vec3(1, 2, 3);
  joints[1] = {"pelvis", 0, {}, kHips};
  joints[2] = {"tail", 1, {}, std::nullopt};
  joints[2].rest.scale = Vec3(1, 2, 1);
  joints[3] = {"neck", 1, {}, kNeck};
  joints[3].rest.translation = Vec3(0, 0.5, 0);
  const Result<Skeleton> skeleton = Skeleton::create(joints);
  ASSERT_TRUE(skeleton.ok());
  RandomNumbers random(10);
  const Pose pose = randomPoseWithinLimits(*skeleton, random);
  ASSERT_EQ(pose.size(), 4u);
  EXPECT_TRUE(withinLimits(*skeleton, pose));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(pose[i].translation, joints[i].rest.translation);
    EXPECT_EQ(pose[i].scale, joints[i].rest.scale);
  }
  EXPECT_EQ(pose[0].rotation.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(pose[2].rotation.coeffs(), Quat::Identity().coeffs());
  EXPECT_GT(angleBetween(pose[3].rotation, Quat::Identity()), 0.01);
}

}  // namespace
}  // namespace lorica
