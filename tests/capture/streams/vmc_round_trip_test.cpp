#include "capture/files/joint_csv.h"
#include "capture/retarget/retarget.h"
#include "capture/retarget/stream_retarget.h"
#include "capture/streams/vmc_receiver.h"
#include "capture/streams/vmc_writer.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/figures.h"
#include "tests/support/allocations.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace lorica {
namespace {

using B = HumanBone;
using test::angleBetween;
using test::degrees;
using test::valueOf;

/// A skeleton that performs a shipped recording, what sends its poses, and what applies them to a character.
struct Performance {
  Skeleton skeleton;
  BonePoseReader reader = valueOf(BonePoseReader::create(skeleton));
  StreamRetargeter retargeter = valueOf(StreamRetargeter::create(skeleton));
  Pose pose = restPose(skeleton);  ///< of the character
  std::vector<Pose> poses = {};
  std::vector<double> times = {};

  Performance(const Skeleton& performer, const std::string& name) : skeleton(performer) {
    Retargeter recorded = valueOf(Retargeter::create(skeleton));
    Pose now = restPose(skeleton);
    for (const SkeletonFrame& frame : valueOf(readJointCsv(test::recordingsFolder() / (name + ".csv")))) {
      recorded.apply(frame, now);
      poses.push_back(now);
      times.push_back(frame.time);
    }
  }
  explicit Performance(const std::string& name) : Performance(makeMannequin().skeleton, name) {}

  /// The largest distance of a joint of the character from where it should be in a frame.
  [[nodiscard]] double worstIn(std::size_t frame) const {
    const std::vector<Affine3> wanted = test::worldOf(skeleton, poses[frame]), got = test::worldOf(skeleton, pose);
    double worst = 0.0;
    for (std::size_t j = 0; j < got.size(); ++j) {
      worst = std::max(worst, (got[j].translation() - wanted[j].translation()).norm());
    }
    return worst;
  }
};

/// What a receiver makes of a pose that another program sends.
BonePose sentAndReceived(BonePoseReader& reader, std::span<const JointTransform> pose) {
  VmcWriter writer;
  VmcReceiver receiver;
  EXPECT_TRUE(receiver.take(writer.write(reader.read(pose), {}, 0.0, true), 0.0));
  return receiver.frame().pose;
}

Vec3 along(const Skeleton& skeleton, const std::vector<Affine3>& world, B from, B to) {
  return world[skeleton.jointOf(to)].translation() - world[skeleton.jointOf(from)].translation();
}

TEST(VmcRoundTrip, TheSameCharacterMovesIdentically) {
  test::FigureSettings crooked;
  crooked.crookedAxes = true;
  crooked.armsDown = degrees(50.0);
  for (const Skeleton& skeleton : {makeMannequin().skeleton, test::makeFigure(crooked).skeleton}) {
    for (const char* name : {"walk", "punch_and_kick"}) {
      Performance walk(skeleton, name);
      ASSERT_FALSE(walk.poses.empty());
      for (std::size_t f = 0; f < walk.poses.size(); ++f) {
        walk.retargeter.apply(sentAndReceived(walk.reader, walk.poses[f]), walk.times[f], true, walk.pose);
        EXPECT_LT(walk.worstIn(f), 1e-4) << name;
      }
    }
  }
}

/// A character of other proportions: limbs point as the sender's do, and feet that stand keep their place.
TEST(VmcRoundTrip, AnotherCharacterPointsItsLimbsAsTheSender) {
  const Skeleton sender = makeMannequin().skeleton;
  test::FigureSettings settings;
  settings.thigh = 0.3;
  settings.shin = 0.5;
  settings.scale = 1.3;
  settings.armsDown = degrees(45.0);
  settings.crookedAxes = true;
  const Skeleton target = test::makeFigure(settings).skeleton;
  Performance jacks(sender, "jumping_jacks");
  RetargetSettings pure;
  pure.plantFeet = false;
  StreamRetargeter retargeter = valueOf(StreamRetargeter::create(target, pure));
  ASSERT_FALSE(jacks.poses.empty());
  Pose pose = restPose(target);
  double worst = 0.0;
  for (std::size_t f = 0; f < jacks.poses.size(); ++f) {
    retargeter.apply(sentAndReceived(jacks.reader, jacks.poses[f]), jacks.times[f], true, pose);
    const std::vector<Affine3> wanted = test::worldOf(sender, jacks.poses[f]);
    const std::vector<Affine3> got = test::worldOf(target, pose);
    for (const LimbBones& limb : limbs()) {
      for (const auto& [from, to] : {std::pair(limb.upper, limb.lower), std::pair(limb.lower, limb.end)}) {
        worst = std::max(worst, angleBetween(along(sender, wanted, from, to), along(target, got, from, to)));
      }
    }
  }
  // The mannequin rests in a T-pose, whose limbs are not exactly straight.
  EXPECT_LT(worst, degrees(8.0));
}

TEST(VmcRoundTrip, FeetThatStandKeepTheirPlaceOnLongerLegs) {
  const Skeleton sender = makeMannequin().skeleton;
  test::FigureSettings settings;
  settings.thigh = 0.5;
  settings.shin = 0.3;
  const Skeleton target = test::makeFigure(settings).skeleton;
  Performance walk(sender, "walk");
  const std::vector<Pose>& poses = walk.poses;
  StreamRetargeter retargeter = valueOf(StreamRetargeter::create(target));
  Pose pose = restPose(target);
  std::array<std::vector<Vec3>, 2> sent;
  std::array<std::vector<Vec3>, 2> got;
  double lowest = 1.0;
  for (std::size_t f = 0; f < poses.size(); ++f) {
    retargeter.apply(sentAndReceived(walk.reader, poses[f]), walk.times[f], true, pose);
    const std::vector<Affine3> from = test::worldOf(sender, poses[f]);
    const std::vector<Affine3> to = test::worldOf(target, pose);
    for (std::size_t side = 0; side < 2; ++side) {
      const B foot = limbs()[kFirstLeg + side].end;
      sent[side].push_back(from[sender.jointOf(foot)].translation());
      got[side].push_back(to[target.jointOf(foot)].translation());
      lowest = std::min(lowest, got[side].back().y());
    }
  }
  // Where the sender's foot stays within 5 mm for a third of a second, ours stays within 2 cm.
  int stances = 0;
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t f = 10; f < poses.size(); ++f) {
      if ((sent[side][f] - sent[side][f - 10]).norm() > 0.005) continue;
      ++stances;
      EXPECT_LT((got[side][f] - got[side][f - 10]).norm(), 0.02) << "frame " << f;
    }
  }
  EXPECT_GT(stances, 20);
  EXPECT_GT(lowest, 0.02);  // an ankle stays above the floor
}

TEST(VmcRoundTrip, MirroringTwiceChangesNothing) {
  Performance wave("wave");
  const BonePose pose = wave.reader.read(wave.poses[wave.poses.size() / 2]);
  const BonePose twice = mirrored(mirrored(pose));
  for (std::size_t b = 0; b < pose.rotation.size(); ++b) {
    ASSERT_EQ(pose.rotation[b].has_value(), twice.rotation[b].has_value());
    if (pose.rotation[b]) {
      EXPECT_LT(pose.rotation[b]->angularDistance(*twice.rotation[b]), 1e-12);
    }
    EXPECT_TRUE(pose.offset[b].isApprox(twice.offset[b]) || pose.offset[b].isZero());
  }
}

/// Some programs send zeros instead of offsets: the character keeps its own proportions.
TEST(StreamRetarget, ZeroOffsetsDoNotCollapseTheCharacter) {
  Performance walk("walk");
  for (std::size_t f = 0; f < walk.poses.size(); f += 7) {
    BonePose sent = sentAndReceived(walk.reader, walk.poses[f]);
    const Vec3 hips = sent.offset[0];
    sent.offset.fill(Vec3::Zero());
    sent.offset[0] = hips;
    walk.retargeter.apply(sent, walk.times[f], true, walk.pose);
    EXPECT_LT(walk.worstIn(f), 1e-4);
  }
}

/// Trackers with a webcam send head and arms, some of them hips at the origin or at the height of a chair.
TEST(StreamRetarget, WithoutLegsTheCharacterStands) {
  test::FigureSettings tall;
  tall.scale = 1.4;
  for (const Skeleton& skeleton : {makeMannequin().skeleton, test::makeFigure(tall).skeleton}) {
    const std::vector<Affine3> rest = test::worldOf(skeleton, restPose(skeleton));
    for (const double hipHeight : {-1.0, 0.0, 0.45, 0.95}) {
      StreamRetargeter retargeter = valueOf(StreamRetargeter::create(skeleton));
      Pose pose = restPose(skeleton);
      BonePose sent;
      for (const B bone : {B::kSpine, B::kNeck, B::kHead, B::kLeftUpperArm, B::kLeftLowerArm}) {
        sent.rotation[static_cast<std::size_t>(bone)] = Quat::Identity();
        sent.offset[static_cast<std::size_t>(bone)] = Vec3(0.0, 0.1, 0.0);
      }
      for (int f = 0; f < 90; ++f) {
        // The first frame of a live stream may lack bones.
        if (hipHeight >= 0.0 && f > 0) sent.rotation[0] = Quat::Identity();
        sent.offset[0] = Vec3(0.0, std::max(0.0, hipHeight), 0.0);
        retargeter.apply(sent, f / 30.0, true, pose);
      }
      for (const B bone : {B::kHips, B::kLeftFoot, B::kRightFoot}) {
        const JointIndex joint = skeleton.jointOf(bone);
        EXPECT_NEAR(retargeter.worldFromJoint()[joint].translation().y(), rest[joint].translation().y(), 1e-6);
      }
    }
  }
}

/// A sender whose avatar hangs half a metre above the floor.
TEST(StreamRetarget, NoAvatarFloats) {
  Performance walk("walk");
  for (std::size_t f = 0; f < 60; ++f) {
    BonePose sent = sentAndReceived(walk.reader, walk.poses[f]);
    sent.rootPosition.y() = 0.5;
    walk.retargeter.apply(sent, walk.times[f], true, walk.pose);
  }
  const std::vector<Affine3> wanted = test::worldOf(walk.skeleton, walk.poses[59]);
  const std::vector<Affine3> got = test::worldOf(walk.skeleton, walk.pose);
  const JointIndex hips = walk.skeleton.jointOf(B::kHips);
  EXPECT_NEAR(got[hips].translation().y(), wanted[hips].translation().y(), 0.06);
}

TEST(StreamRetarget, SilenceHoldsAndReturnsWithoutAJump) {
  Performance jacks("jumping_jacks");
  const std::vector<double>& times = jacks.times;
  std::vector<Vec3> hands;
  for (std::size_t f = 0; f < times.size() && times[f] < 6.0; ++f) {
    const bool silent = times[f] > 1.0 && times[f] < 3.5;
    jacks.retargeter.apply(sentAndReceived(jacks.reader, jacks.poses[f]), times[f], !silent, jacks.pose);
    hands.push_back(test::worldOf(jacks.skeleton, jacks.pose)[jacks.skeleton.jointOf(B::kLeftHand)].translation());
  }
  double fastest = 0.0;
  for (std::size_t f = 1; f < hands.size(); ++f) {
    fastest = std::max(fastest, (hands[f] - hands[f - 1]).norm() / (times[f] - times[f - 1]));
  }
  EXPECT_LT(fastest, 14.0);  // of the hands themselves and of the blend
}

TEST(StreamRetarget, AllocatesNothingPerFrame) {
  const Skeleton skeleton = makeMannequin().skeleton;
  BonePoseReader reader = valueOf(BonePoseReader::create(skeleton));
  StreamRetargeter retargeter = valueOf(StreamRetargeter::create(skeleton));
  VmcWriter writer;
  VmcReceiver receiver;
  Pose pose = restPose(skeleton);
  receiver.take(writer.write(reader.read(pose), {}, 0.0, true), 0.0);  // makes the table of names
  const long before = test::allocationCount();
  for (int i = 0; i < 10; ++i) {
    receiver.take(writer.write(reader.read(pose), {}, 0.1 * i, true), 0.1 * i);
    retargeter.apply(receiver.frame().pose, 0.1 * i, true, pose);
  }
  EXPECT_EQ(test::allocationCount(), before);
}

}  // namespace
}  // namespace lorica
