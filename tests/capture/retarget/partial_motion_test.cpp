#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "capture/retarget/retarget_rig.h"
#include "capture/retarget/skeletal_retarget.h"
#include "skinning/humanoid/humanoid.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/figures.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

/// Motions of skeletons that lack bones, compared with the same motions with all bones.
namespace lorica {
namespace {

using test::degrees;
using B = HumanBone;
using Bones = std::set<B>;

const Bones kArms = {B::kLeftUpperArm,  B::kLeftLowerArm,  B::kLeftHand,
                     B::kRightUpperArm, B::kRightLowerArm, B::kRightHand};
const Bones kLegs = {B::kLeftUpperLeg,  B::kLeftLowerLeg,  B::kLeftFoot,
                     B::kRightUpperLeg, B::kRightLowerLeg, B::kRightFoot};
const Bones kTrunk = {B::kHips, B::kSpine, B::kNeck, B::kHead};

SkeletalMotion recorded(const char* name) {
  const auto frames = readJointCsv(test::recordingsFolder() / (std::string(name) + ".csv"));
  EXPECT_TRUE(frames) << frames.error().message;
  Result<SkeletalMotion> motion = skeletalMotionOf(*frames);
  EXPECT_TRUE(motion) << motion.error().message;
  return std::move(*motion);
}

/// The motion without the joints of some bones; their children are attached to the next joint above, at unchanged
/// positions.
SkeletalMotion without(const SkeletalMotion& motion, const Bones& bones) {
  SkeletalMotion out;
  out.name = "part";
  out.times = motion.times;
  const std::span<const Joint> all = motion.skeleton.joints();
  std::vector<JointIndex> newIndex(all.size(), kNoJoint);
  std::vector<Joint> joints;
  const auto isKept = [&](std::size_t j) { return !all[j].bone || !bones.contains(*all[j].bone); };
  const auto local = [&](std::size_t j, const auto& localOf) {
    JointTransform t = localOf(j);
    JointIndex above = all[j].parent;
    for (; above != kNoJoint && !isKept(static_cast<std::size_t>(above)); above = all[above].parent) {
      const JointTransform& p = localOf(static_cast<std::size_t>(above));
      t.translation = p.translation + p.rotation * t.translation;
      t.rotation = p.rotation * t.rotation;
    }
    return std::pair(t, above);
  };
  for (std::size_t j = 0; j < all.size(); ++j) {
    if (!isKept(j)) continue;
    const auto [rest, above] = local(j, [&](std::size_t k) -> const JointTransform& { return all[k].rest; });
    newIndex[j] = static_cast<JointIndex>(joints.size());
    joints.push_back({all[j].name, above == kNoJoint ? kNoJoint : newIndex[above], rest, all[j].bone});
  }
  for (int f = 0; f < motion.frameCount(); ++f) {
    const std::span<const JointTransform> pose = motion.pose(f);
    for (std::size_t j = 0; j < all.size(); ++j) {
      if (isKept(j))
        out.poses.push_back(local(j, [&](std::size_t k) -> const JointTransform& { return pose[k]; }).first);
    }
  }
  out.skeleton = *Skeleton::create(std::move(joints));
  return out;
}

SkeletalMotion onMannequin(const SkeletalMotion& source) {
  Result<SkeletalMotion> out = retargetMotion(source, makeMannequin().skeleton);
  EXPECT_TRUE(out) << out.error().message;
  return out ? std::move(*out) : SkeletalMotion();
}

/// Largest angle between the world rotations of some bones in two motions of one skeleton [rad].
double farthestTurn(const SkeletalMotion& a, const SkeletalMotion& b, const Bones& bones) {
  double farthest = 0.0;
  const auto rotations = [](const SkeletalMotion& motion, int f) {
    std::vector<Quat> world;
    const std::span<const JointTransform> pose = motion.pose(f);
    for (std::size_t j = 0; j < pose.size(); ++j) {
      const JointIndex parent = motion.skeleton.joint(static_cast<JointIndex>(j)).parent;
      world.push_back(parent == kNoJoint ? pose[j].rotation : world[parent] * pose[j].rotation);
    }
    return world;
  };
  EXPECT_EQ(a.frameCount(), b.frameCount());
  for (int f = 0; f < a.frameCount(); ++f) {
    const std::vector<Quat> left = rotations(a, f);
    const std::vector<Quat> right = rotations(b, f);
    for (const B bone : bones) {
      const auto joint = static_cast<std::size_t>(a.skeleton.jointOf(bone));
      farthest = std::max(farthest, left[joint].angularDistance(right[joint]));
    }
  }
  return farthest;
}

void expectAtRest(const SkeletalMotion& motion, const Bones& bones) {
  for (int f = 0; f < motion.frameCount(); ++f) {
    for (const B bone : bones) {
      const JointIndex joint = motion.skeleton.jointOf(bone);
      ASSERT_EQ(motion.pose(f)[joint].rotation.coeffs(), motion.skeleton.joint(joint).rest.rotation.coeffs())
          << nameOf(bone) << " in frame " << f;
    }
  }
}

Bones restOf(const SkeletalMotion& source) {
  const Result<std::vector<B>> bones = bonesLeftAtRest(source.skeleton);
  EXPECT_TRUE(bones) << bones.error().message;
  return bones ? Bones(bones->begin(), bones->end()) : Bones();
}

double lowestSole(const SkeletalMotion& motion, int f) {
  const RetargetRig rig = *RetargetRig::create(motion.skeleton);
  const std::span<const JointTransform> pose = motion.pose(f);
  const std::vector<Affine3> world = test::worldOf(motion.skeleton, Pose(pose.begin(), pose.end()));
  double lowest = 1e9;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto at = [&](B left, B right) -> const Affine3& {
      return world[motion.skeleton.jointOf(side == 0 ? left : right)];
    };
    const Affine3& foot = at(B::kLeftFoot, B::kRightFoot);
    lowest = std::min({lowest, (foot * rig.sole[side].heel).y(), (foot * rig.sole[side].ball).y(),
                       (at(B::kLeftToes, B::kRightToes) * rig.sole[side].tip).y()});
  }
  return lowest;
}

TEST(PartialMotion, OfAWholeSkeletonNothingIsLeftAtRest) {
  EXPECT_TRUE(restOf(recorded("walk")).empty());
}

TEST(PartialMotion, AnUpperBodyMovesArmsAndTrunkWhileTheLegsStandAtRest) {
  for (const char* name : {"jumping_jacks", "squat_and_reach", "turn_around"}) {
    SCOPED_TRACE(name);
    const SkeletalMotion whole = recorded(name);
    const SkeletalMotion upper = without(whole, kLegs);
    EXPECT_EQ(restOf(upper), kLegs);
    const SkeletalMotion out = onMannequin(upper);
    expectAtRest(out, kLegs);
    Bones moving = kArms;
    moving.insert(kTrunk.begin(), kTrunk.end());
    EXPECT_LT(farthestTurn(out, onMannequin(whole), moving), degrees(1e-4));
    for (int f = 0; f < out.frameCount(); ++f) ASSERT_NEAR(lowestSole(out, f), 0.0, 1e-9);
  }
}

TEST(PartialMotion, LegsWalkWhileTheArmsAreAtRest) {
  const SkeletalMotion whole = recorded("walk");
  const SkeletalMotion legs = without(whole, kArms);
  EXPECT_EQ(restOf(legs), kArms);
  const SkeletalMotion out = onMannequin(legs);
  expectAtRest(out, kArms);
  // The trunk's rest frame came from the shoulders and now comes from the hips; in this skeleton both agree.
  EXPECT_LT(farthestTurn(out, onMannequin(whole), kLegs), degrees(0.5));
}

TEST(PartialMotion, OneArmIsEnough) {
  const Bones rest = {B::kRightUpperArm, B::kRightLowerArm, B::kRightHand};
  const SkeletalMotion whole = recorded("wave");
  const SkeletalMotion part = without(whole, rest);
  EXPECT_EQ(restOf(part), rest);
  const SkeletalMotion out = onMannequin(part);
  expectAtRest(out, rest);
  EXPECT_LT(farthestTurn(out, onMannequin(whole), {B::kLeftUpperArm, B::kLeftLowerArm}), degrees(1e-4));
}

TEST(PartialMotion, MirroredTheOtherArmMoves) {
  const SkeletalMotion part = without(recorded("wave"), {B::kRightUpperArm, B::kRightLowerArm, B::kRightHand});
  const SkeletalMotion out =
      test::valueOf(retargetMotion(part, makeMannequin().skeleton, {.mirror = true, .plantFeet = true}));
  expectAtRest(out, {B::kLeftUpperArm, B::kLeftLowerArm, B::kLeftHand});
}

TEST(PartialMotion, WithoutHandsAndFeetTheLimbsPointAsBeforeIfSomethingIsAtTheirEnds) {
  const Bones ends = {B::kLeftHand, B::kRightHand, B::kLeftFoot, B::kRightFoot};
  const SkeletalMotion whole = recorded("squat_and_reach");
  SkeletalMotion part = whole;
  std::vector<Joint> joints(part.skeleton.joints().begin(), part.skeleton.joints().end());
  for (Joint& joint : joints) {
    if (joint.bone && ends.contains(*joint.bone)) joint.bone.reset();
  }
  part.skeleton = *Skeleton::create(std::move(joints));
  EXPECT_EQ(restOf(part), ends);
  const SkeletalMotion out = onMannequin(part);
  expectAtRest(out, {B::kLeftHand, B::kRightHand});
  EXPECT_LT(
      farthestTurn(out, onMannequin(whole), {B::kLeftUpperArm, B::kRightUpperArm, B::kLeftLowerArm, B::kRightLowerArm}),
      degrees(1e-4));
}

TEST(PartialMotion, WithNothingAtTheirEndsLimbsAreTakenForStraightAtRest) {
  // The skeleton of joints is built in T-pose, so that is the ground truth.
  const Bones ends = {B::kLeftHand, B::kRightHand, B::kLeftFoot, B::kRightFoot};
  const SkeletalMotion whole = recorded("jumping_jacks");
  const SkeletalMotion part = without(whole, ends);
  EXPECT_EQ(restOf(part), ends);
  EXPECT_LT(farthestTurn(onMannequin(part), onMannequin(whole),
                         {B::kLeftUpperArm, B::kRightUpperArm, B::kLeftLowerArm, B::kRightLowerArm}),
            degrees(1e-4));
}

TEST(PartialMotion, WithoutHipsTheBodyGoesWhereTheTrunkGoes) {
  Bones lacking = kLegs;
  lacking.insert(B::kHips);
  const SkeletalMotion whole = recorded("walk");
  const SkeletalMotion part = without(whole, lacking);
  EXPECT_EQ(restOf(part), kLegs);
  const SkeletalMotion out = onMannequin(part);
  expectAtRest(out, kLegs);
  EXPECT_LT(farthestTurn(out, onMannequin(whole), kArms), degrees(1e-4));
  const auto hips = [](const SkeletalMotion& motion, int f) {
    return motion.pose(f)[motion.skeleton.jointOf(B::kHips)].translation;
  };
  const SkeletalMotion truth = onMannequin(whole);
  double farthest = 0.0;
  for (int f = 0; f < out.frameCount(); ++f) {
    const Vec3 way = hips(out, f) - hips(out, 0);
    const Vec3 trueWay = hips(truth, f) - hips(truth, 0);
    farthest = std::max(farthest, trueWay.norm());
    // The trunk sways above the hips, and the ratio comes from legs of guessed length.
    ASSERT_LT(std::hypot(way.x() - trueWay.x(), way.z() - trueWay.z()), 0.1 + 0.1 * trueWay.norm());
  }
  EXPECT_GT(farthest, 1.0);
}

TEST(PartialMotion, WithoutASpineTheHipsCarryTheArms) {
  const SkeletalMotion whole = recorded("wave");
  const SkeletalMotion out = onMannequin(without(whole, {B::kSpine}));
  EXPECT_LT(farthestTurn(out, onMannequin(whole), kArms), degrees(1e-4));
}

TEST(PartialMotion, AHeadAloneIsRefused) {
  Bones lacking = kLegs;
  lacking.insert(kArms.begin(), kArms.end());
  const SkeletalMotion part = without(recorded("walk"), lacking);
  const Result<std::vector<B>> rest = bonesLeftAtRest(part.skeleton);
  ASSERT_FALSE(rest);
  EXPECT_NE(rest.error().message.find("leftUpperArm"), std::string::npos) << rest.error().message;
  EXPECT_FALSE(retargetMotion(part, makeMannequin().skeleton));
}

TEST(PartialMotion, JointsThatAreLackingAreUnknownAndEndsAreGuessed) {
  const std::vector<SkeletonFrame> upper = test::valueOf(bodyJointsOf(without(recorded("wave"), kLegs)));
  EXPECT_EQ(upper.front()[BodyJoint::kLeftKnee].confidence, 0.0);
  EXPECT_EQ(upper.front()[BodyJoint::kLeftFoot].confidence, 0.0);
  EXPECT_EQ(upper.front()[BodyJoint::kLeftHand].confidence, 1.0);

  const SkeletalMotion whole = recorded("jumping_jacks");
  const Result<std::vector<SkeletonFrame>> all = bodyJointsOf(whole);
  const Result<std::vector<SkeletonFrame>> part = bodyJointsOf(without(whole, {B::kLeftHand}));
  ASSERT_TRUE(all && part);
  for (std::size_t f = 0; f < all->size(); ++f) {
    const TrackedJoint& hand = (*part)[f][BodyJoint::kLeftHand];
    ASSERT_EQ(hand.confidence, 0.5);
    ASSERT_FALSE(hand.orientation.has_value());
    const Vec3& elbow = (*all)[f][BodyJoint::kLeftElbow].position;
    const Vec3 truth = (*all)[f][BodyJoint::kLeftHand].position - elbow;
    ASSERT_LT(test::angleBetween(hand.position - elbow, truth), degrees(0.1));
  }
}

constexpr const char* kUpperBodyBvh = R"(HIERARCHY
ROOT Hips
{
  OFFSET 0 100 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Spine
  {
    OFFSET 0 10 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT Neck
    {
      OFFSET 0 40 0
      CHANNELS 3 Zrotation Xrotation Yrotation
      JOINT Head
      {
        OFFSET 0 10 0
        CHANNELS 3 Zrotation Xrotation Yrotation
        End Site
        { OFFSET 0 15 0 }
      }
    }
    JOINT LeftArm
    {
      OFFSET 18 35 0
      CHANNELS 3 Zrotation Xrotation Yrotation
      JOINT LeftForeArm
      {
        OFFSET 28 0 0
        CHANNELS 3 Zrotation Xrotation Yrotation
        End Site
        { OFFSET 0 -25 0 }
      }
    }
    JOINT RightArm
    {
      OFFSET -18 35 0
      CHANNELS 3 Zrotation Xrotation Yrotation
      JOINT RightForeArm
      {
        OFFSET -28 0 0
        CHANNELS 3 Zrotation Xrotation Yrotation
        End Site
        { OFFSET -25 0 0 }
      }
    }
  }
}
MOTION
Frames: 1
Frame Time: 0.05
0 100 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0  0 0 0
)";

TEST(PartialMotion, ABvhOfAnUpperBodyIsReadByItsNamesAndEndSites) {
  const BvhFile file = test::valueOf(parseBvh(kUpperBodyBvh, "upper.bvh"));
  const Skeleton& skeleton = file.motion.skeleton;
  for (const auto& [bone, name] :
       {std::pair(B::kHips, "Hips"), std::pair(B::kSpine, "Spine"), std::pair(B::kHead, "Head"),
        std::pair(B::kLeftLowerArm, "LeftForeArm"), std::pair(B::kRightUpperArm, "RightArm")}) {
    ASSERT_NE(skeleton.jointOf(bone), kNoJoint) << name;
    EXPECT_EQ(skeleton.joint(skeleton.jointOf(bone)).name, name);
  }
  EXPECT_EQ(skeleton.jointOf(B::kLeftHand), kNoJoint);
  EXPECT_EQ(skeleton.jointCount(), 10);  // the forearms' end sites become joints, that of the head does not
  Bones rest = kLegs;
  rest.insert({B::kLeftHand, B::kRightHand});
  EXPECT_EQ(restOf(file.motion), rest);

  // The left forearm points straight down in the file.
  const SkeletalMotion out = onMannequin(file.motion);
  const std::span<const JointTransform> pose = out.pose(0);
  const std::vector<Affine3> world = test::worldOf(out.skeleton, Pose(pose.begin(), pose.end()));
  const auto position = [&](B bone) -> Vec3 { return world[out.skeleton.jointOf(bone)].translation(); };
  EXPECT_LT(test::angleBetween(position(B::kLeftHand) - position(B::kLeftLowerArm), -Vec3::UnitY()), degrees(0.01));
  EXPECT_LT(test::angleBetween(position(B::kRightHand) - position(B::kRightLowerArm), -Vec3::UnitX()), degrees(0.01));
}

}  // namespace
}  // namespace lorica
