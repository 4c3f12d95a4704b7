#include "skinning/humanoid/joint_limits.h"

#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "skinning/mannequin/mannequin_skeleton.h"
#include "tests/support/value_of.h"

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

/// Direction of a bone that pointed along `rest` in T-pose, after its joint is rotated by these angles.
Vec3 turned(HumanBone bone, const JointAngles& angles, const Vec3& rest) {
  return rotationOf(jointRange(bone), angles) * rest;
}

const Quat& rotationIn(const Skeleton& skeleton, const Pose& pose, HumanBone bone) {
  return pose[skeleton.jointOf(bone)].rotation;
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
  double min = 1.0, max = 0.0, sum = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const double value = random.between(2.0, 5.0);
    min = std::min(min, (value - 2.0) / 3.0);
    max = std::max(max, (value - 2.0) / 3.0);
    sum += value / 10000.0;
  }
  EXPECT_GE(min, 0.0);
  EXPECT_LT(min, 0.01);
  EXPECT_LT(max, 1.0);
  EXPECT_GT(max, 0.99);
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
      EXPECT_LE(angle.min, 0.0) << nameOf(bone);
      EXPECT_GE(angle.max, 0.0) << nameOf(bone);
      EXPECT_LT(angle.max - angle.min, 2.0 * std::numbers::pi + 1e-9) << nameOf(bone);
    }
    EXPECT_GT(range.first.max - range.first.min + range.twist.max, 0.0) << nameOf(bone) << " does not move";
  }
}

TEST(JointLimits, MovementsGoTheWayAnatomySays) {
  const Vec3 up = Vec3::UnitY(), forward = Vec3::UnitZ(), left = Vec3::UnitX();
  const auto max = [](HumanBone bone) { return JointAngles{0.0, jointRange(bone).first.max, 0.0}; };
  const auto min = [](HumanBone bone) { return JointAngles{0.0, jointRange(bone).first.min, 0.0}; };
  const auto secondMax = [](HumanBone bone) { return JointAngles{0.0, 0.0, jointRange(bone).second.max}; };
  const auto secondMin = [](HumanBone bone) { return JointAngles{0.0, 0.0, jointRange(bone).second.min}; };
  const auto twistMax = [](HumanBone bone) { return JointAngles{jointRange(bone).twist.max, 0.0, 0.0}; };
  const auto twistMin = [](HumanBone bone) { return JointAngles{jointRange(bone).twist.min, 0.0, 0.0}; };

  // Knee and elbow bend one way: heel to the back, hand to the front and on to the shoulder.
  EXPECT_LT(turned(kLeftLowerLeg, max(kLeftLowerLeg), -up).z(), -0.7);
  EXPECT_GT(turned(kLeftLowerLeg, max(kLeftLowerLeg), -up).y(), 0.7);
  EXPECT_EQ(jointRange(kLeftLowerLeg).first.min, 0.0);
  EXPECT_EQ(jointRange(kLeftLowerLeg).second.max - jointRange(kLeftLowerLeg).second.min, 0.0);
  EXPECT_GT(turned(kLeftLowerArm, {0.0, 90.0 * kDegree, 0.0}, left).dot(forward), 0.999999);
  EXPECT_NEAR(turned(kLeftLowerArm, max(kLeftLowerArm), left).x(), std::cos(150.0 * kDegree), 1e-12);
  EXPECT_EQ(jointRange(kLeftLowerArm).first.min, 0.0);

  // Thigh: 120 degrees forward is above the horizontal; back 30; out 45.
  EXPECT_NEAR(turned(kLeftUpperLeg, min(kLeftUpperLeg), -up).y(), 0.5, 1e-12);
  EXPECT_GT(turned(kLeftUpperLeg, min(kLeftUpperLeg), -up).z(), 0.8);
  EXPECT_NEAR(turned(kLeftUpperLeg, max(kLeftUpperLeg), -up).z(), -0.5, 1e-12);
  EXPECT_NEAR(turned(kLeftUpperLeg, secondMin(kLeftUpperLeg), -up).x(), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(turned(kRightUpperLeg, secondMin(kRightUpperLeg), -up).x(), -std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(turned(kLeftUpperLeg, secondMax(kLeftUpperLeg), -up).x(), -0.5, 1e-12);

  // Foot: toes up 20, down 50; its sole rotates in (to the right of the left foot) further than out.
  EXPECT_NEAR(turned(kLeftFoot, min(kLeftFoot), forward).y(), std::sin(20.0 * kDegree), 1e-12);
  EXPECT_NEAR(turned(kLeftFoot, max(kLeftFoot), forward).y(), -std::sin(50.0 * kDegree), 1e-12);
  EXPECT_NEAR(turned(kLeftFoot, twistMin(kLeftFoot), -up).x(), -std::sin(35.0 * kDegree), 1e-12);
  EXPECT_GT(turned(kLeftToes, min(kLeftToes), forward).y(), 0.9);

  // Arm with collarbone: straight up, hanging, 135 forward.
  EXPECT_GT(
      (rotationOf(jointRange(kLeftShoulder), max(kLeftShoulder)) * turned(kLeftUpperArm, max(kLeftUpperArm), left))
          .dot(up),
      0.999999);
  EXPECT_GT(turned(kLeftUpperArm, min(kLeftUpperArm), left).dot(-up), 0.999999);
  const Vec3 across = rotationOf(jointRange(kLeftShoulder), secondMax(kLeftShoulder)) *
                      turned(kLeftUpperArm, secondMax(kLeftUpperArm), left);
  EXPECT_NEAR(across.x(), std::cos(135.0 * kDegree), 1e-12);
  EXPECT_NEAR(across.z(), std::sin(135.0 * kDegree), 1e-12);
  // A forearm bent forward moves up with lateral rotation (90) and down with medial (70), on both sides.
  for (const HumanBone arm : {kLeftUpperArm, kRightUpperArm}) {
    EXPECT_GT(turned(arm, twistMin(arm), forward).dot(up), 0.999999);
    EXPECT_NEAR(turned(arm, twistMax(arm), forward).y(), -std::sin(70.0 * kDegree), 1e-12);
  }

  // Supination turns the palm, which faces down, to the front and then up: 160 degrees by forearm and hand together.
  const Quat supine = rotationOf(jointRange(kLeftLowerArm), twistMin(kLeftLowerArm)) *
                      rotationOf(jointRange(kLeftHand), twistMin(kLeftHand));
  EXPECT_NEAR((supine * -up).y(), std::cos(20.0 * kDegree), 1e-12);
  EXPECT_GT((rotationOf(jointRange(kLeftHand), twistMin(kLeftHand)) * -up).z(), 0.9);
  EXPECT_NEAR(turned(kLeftHand, min(kLeftHand), left).y(), -std::sin(80.0 * kDegree), 1e-12);
  EXPECT_NEAR(turned(kLeftHand, secondMax(kLeftHand), left).z(), std::sin(20.0 * kDegree), 1e-12);

  // A fist: fingers roll down and back under the palm. Spread: index to the front, little finger to the back.
  const Vec3 fingertip = rotationOf(jointRange(kLeftIndexProximal), {0.0, 90.0 * kDegree, 0.0}) *
                         turned(kLeftIndexIntermediate, {0.0, 90.0 * kDegree, 0.0}, left);
  EXPECT_GT(fingertip.dot(-left), 0.999999);
  EXPECT_GT(turned(kLeftIndexProximal, secondMin(kLeftIndexProximal), left).z(), 0.3);
  EXPECT_LT(turned(kLeftLittleProximal, secondMax(kLeftLittleProximal), left).z(), -0.3);
  // The thumb leaves the palm downward and bends to the fingers.
  const Vec3 thumb = Vec3(1, 0, 1).normalized();
  EXPECT_LT(turned(kLeftThumbMetacarpal, max(kLeftThumbMetacarpal), thumb).y(), -0.9);
  EXPECT_LT(turned(kLeftThumbMetacarpal, secondMax(kLeftThumbMetacarpal), thumb).z(), thumb.z());
  EXPECT_LT(turned(kLeftThumbDistal, max(kLeftThumbDistal), thumb).y(), -0.5);
  EXPECT_LT(turned(kLeftThumbDistal, max(kLeftThumbDistal), thumb).z(), 0.0);

  // Trunk: chin to the chest, all of the spine 80 forward.
  EXPECT_GT(turned(kHead, max(kHead), up).z(), 0.3);
  EXPECT_NEAR(jointRange(kSpine).first.max + jointRange(kChest).first.max + jointRange(kUpperChest).first.max,
              80.0 * kDegree, 1e-12);
  EXPECT_GT(turned(kSpine, max(kSpine), up).z(), 0.4);
}

TEST(JointLimits, RotationsEqualThoseBySines) {
  RandomNumbers random(3);
  for (int i = 0; i < 2000; ++i) {
    const JointRange& range = jointRange(allBones()[i % kHumanBoneCount]);
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
    const JointRange& range = jointRange(allBones()[i % kHumanBoneCount]);
    const JointAngles angles{random.between(-3.1, 3.1), random.between(-2.2, 2.2), random.between(-2.2, 2.2)};
    // Both quaternions of a rotation are the same rotation.
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
    if (bone == kHips) continue;  // rotates fully
    const JointRange& range = jointRange(bone);
    const auto isWithin = [&](const JointAngles& angles) {
      Pose pose = restPose(skeleton);
      pose[skeleton.jointOf(bone)].rotation = rotationOf(range, angles);
      return withinLimits(skeleton, pose);
    };
    for (const auto& [angle, allowed] : {std::pair{&JointAngles::twist, range.twist},
                                         {&JointAngles::first, range.first},
                                         {&JointAngles::second, range.second}}) {
      for (const auto& [end, beyond] : {std::pair{allowed.max, kDegree}, {allowed.min, -kDegree}}) {
        JointAngles angles{0.0, 0.0, 0.0};
        angles.*angle = end;
        EXPECT_TRUE(isWithin(angles)) << nameOf(bone) << ", " << end;
        angles.*angle += beyond;
        EXPECT_FALSE(isWithin(angles)) << nameOf(bone) << ", " << end;
      }
    }
    // Not both ends at once.
    if (range.first.max * range.second.max > 0.0) {
      EXPECT_FALSE(isWithin({0.0, 0.8 * range.first.max, 0.8 * range.second.max})) << nameOf(bone);
      EXPECT_TRUE(isWithin({0.0, 0.7 * range.first.max, 0.7 * range.second.max})) << nameOf(bone);
    }
  }
}

/// The range of angles in random poses, per bone.
struct Seen {
  JointAngles min{9.0, 9.0, 9.0}, max{-9.0, -9.0, -9.0};
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
        seen.min.*angle = std::min(seen.min.*angle, angles.*angle);
        seen.max.*angle = std::max(seen.max.*angle, angles.*angle);
      }
    }
  }
  for (const HumanBone bone : allBones()) {
    const JointRange& range = jointRange(bone);
    const Seen& seen = seenOf[bone];
    const auto expectReached = [&](const AngleRange& allowed, double min, double max) {
      const double close = 0.06 * (allowed.max - allowed.min) + 1e-6;
      EXPECT_NEAR(min, allowed.min, close) << nameOf(bone);
      EXPECT_NEAR(max, allowed.max, close) << nameOf(bone);
    };
    expectReached(range.twist, seen.min.twist, seen.max.twist);
    expectReached(range.first, seen.min.first, seen.max.first);
    expectReached(range.second, seen.min.second, seen.max.second);
  }
}

/// Independent of the code's swings and twists: positions of elbows, knees and heads by forward kinematics.
TEST(RandomPose, PutsBonesWhereBodiesCan) {
  const Skeleton skeleton = makeMannequinSkeleton();
  RandomNumbers random(6);
  std::vector<Affine3> world(skeleton.jointCount());
  const auto at = [&](HumanBone bone) -> const Affine3& { return world[skeleton.jointOf(bone)]; };
  for (int i = 0; i < 2000; ++i) {
    const Pose pose = randomPoseWithinLimits(skeleton, random);
    computeWorldFromJoint(skeleton, pose, world);
    EXPECT_TRUE(at(kHips).translation().isApprox(mannequinJoint(kHips)));
    EXPECT_GT((at(kHips).linear() * Vec3::UnitY()).y(), 0.999999);
    struct Limb {
      HumanBone upper, lower, end;
      double maxDegrees;
    };
    for (const Limb& limb :
         {Limb{kLeftUpperArm, kLeftLowerArm, kLeftHand, 150.0}, Limb{kRightUpperArm, kRightLowerArm, kRightHand, 150.0},
          Limb{kLeftUpperLeg, kLeftLowerLeg, kLeftFoot, 135.0},
          Limb{kRightUpperLeg, kRightLowerLeg, kRightFoot, 135.0}}) {
      const Vec3 joint = at(limb.lower).translation();
      const Vec3 along = (joint - at(limb.upper).translation()).normalized();
      const Vec3 beyond = (at(limb.end).translation() - joint).normalized();
      // The bones of a straight limb are not exactly collinear: 5 degrees in the leg.
      EXPECT_LT(std::acos(std::clamp(along.dot(beyond), -1.0, 1.0)), (limb.maxDegrees + 6.0) * kDegree);
      const bool isArm = limb.end == kLeftHand || limb.end == kRightHand;
      const Vec3 fore = at(limb.upper).linear() * Vec3::UnitZ();
      const Vec3 aside = at(limb.upper).linear() * (isArm ? Vec3::UnitY() : Vec3::UnitX());
      EXPECT_GT((isArm ? 1.0 : -1.0) * fore.dot(beyond), -0.1) << nameOf(limb.lower) << " bent the wrong way";
      EXPECT_LT(std::abs(aside.dot(beyond)), 0.05) << nameOf(limb.lower) << " bent sideways";
      // Lengths are preserved.
      EXPECT_NEAR((at(limb.end).translation() - joint).norm(),
                  (mannequinJoint(limb.end) - mannequinJoint(limb.lower)).norm(), 1e-12);
    }
    // The face does not turn behind the shoulders' plane by more than neck and spine rotate together.
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
  std::vector<Affine3> world(skeleton.jointCount()), mirroredWorld = world;
  for (int i = 0; i < 200; ++i) {
    const Pose pose = randomPoseWithinLimits(skeleton, random);
    // The mirror image of a rotation keeps the x of its axis and reverses y and z.
    Pose reflected = pose;
    for (const HumanBone bone : allBones()) {
      const Quat& q = rotationIn(skeleton, pose, bone);
      reflected[skeleton.jointOf(mirrored(bone))].rotation = Quat(q.w(), q.x(), -q.y(), -q.z());
    }
    EXPECT_TRUE(withinLimits(skeleton, reflected));
    computeWorldFromJoint(skeleton, pose, world);
    computeWorldFromJoint(skeleton, reflected, mirroredWorld);
    for (const HumanBone bone : allBones()) {
      const Vec3 p = world[skeleton.jointOf(bone)].translation();
      const Vec3 q = mirroredWorld[skeleton.jointOf(mirrored(bone))].translation();
      EXPECT_LT((Vec3(-p.x(), p.y(), p.z()) - q).norm(), 1e-12) << nameOf(bone);
    }
  }
  for (const HumanBone bone : allBones()) {
    EXPECT_EQ(jointRange(bone).first.max, jointRange(mirrored(bone)).first.max);
    EXPECT_EQ(jointRange(bone).second.min, jointRange(mirrored(bone)).second.min);
    EXPECT_EQ(jointRange(bone).twist.min, jointRange(mirrored(bone)).twist.min);
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
  const Skeleton skeleton = test::valueOf(Skeleton::create(joints));
  RandomNumbers random(10);
  const Pose pose = randomPoseWithinLimits(skeleton, random);
  ASSERT_EQ(pose.size(), 4u);
  EXPECT_TRUE(withinLimits(skeleton, pose));
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
