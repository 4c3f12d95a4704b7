#include "capture/streams/vmc_receiver.h"

#include "capture/streams/vmc_names.h"
#include "geometry/work_budgets.h"
#include "tests/capture/streams/vmc_packet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace lorica {
namespace {

using B = HumanBone;

using test::Packet;

bool take(VmcReceiver& receiver, const Packet& packet, double seconds) {
  return receiver.take(packet.bytes(), seconds);
}

TEST(VmcNames, AreUnitys) {
  EXPECT_EQ(vmcNameOf(B::kHips), "Hips");
  EXPECT_EQ(vmcNameOf(B::kLeftUpperArm), "LeftUpperArm");
  EXPECT_EQ(vmcNameOf(B::kLeftThumbMetacarpal), "LeftThumbProximal");
  EXPECT_EQ(vmcNameOf(B::kLeftThumbProximal), "LeftThumbIntermediate");
  EXPECT_EQ(vmcNameOf(B::kRightThumbDistal), "RightThumbDistal");
  for (int b = 0; b < kHumanBoneCount; ++b) {
    EXPECT_EQ(vmcBoneNamed(vmcNameOf(static_cast<B>(b))), static_cast<B>(b));
  }
  EXPECT_EQ(vmcBoneNamed("leftUpperArm"), B::kLeftUpperArm);
  EXPECT_EQ(vmcBoneNamed("leftThumbMetacarpal"), B::kLeftThumbMetacarpal);
  for (const char* other : {"", "LeftEye", "Jaw", "LastBone", "hipsy", "LEFTUPPERARM"}) {
    EXPECT_FALSE(vmcBoneNamed(other)) << other;
  }
}

/// A turn of 90 degrees about Unity's +Y (clockwise from above) moves the left hand, at -X there, to +Z.
TEST(VmcReceiver, AxesAreConverted) {
  VmcReceiver receiver;
  const auto half = static_cast<float>(std::sqrt(0.5));
  EXPECT_TRUE(take(receiver, Packet().bundle().bone("Hips", {-0.3f, 0.9f, 0.2f, 0, half, 0, half}), 1.0));
  const BonePose& pose = receiver.frame().pose;
  EXPECT_TRUE(pose.offset[0].isApprox(Vec3(0.3, 0.9, 0.2), 1e-6));
  const Vec3 left = *pose.rotation[0] * Vec3::UnitX();
  EXPECT_TRUE(left.isApprox(Vec3::UnitZ(), 1e-6)) << left.transpose();
  EXPECT_EQ(receiver.frame().time, 1.0);
}

TEST(VmcReceiver, ABundleWithAllBonesIsAFrame) {
  VmcReceiver receiver;
  EXPECT_TRUE(take(receiver, Packet().bundle().bone("Hips").bone("Spine"), 0.0));
  EXPECT_TRUE(take(receiver, Packet().bundle().bone("Hips").bone("Spine"), 0.01));
  EXPECT_EQ(receiver.frame().time, 0.01);
  EXPECT_EQ(receiver.refusedCount(), 0);
}

/// Our own bundles and others that stay below 1,500 bytes: one body in two.
TEST(VmcReceiver, ABodyInTwoBundlesIsOneFrame) {
  VmcReceiver receiver;
  take(receiver, Packet().bundle().bone("Hips"), 0.0);
  for (int i = 0; i < 5; ++i) {
    take(receiver, Packet().bundle().bone("Spine"), 0.0333 * i + 0.0001);
    EXPECT_EQ(take(receiver, Packet().bundle().bone("Hips"), 0.0333 * (i + 1)), i == 0);  // at first it is not known
  }
  EXPECT_TRUE(take(receiver, Packet().bundle().bone("Spine"), 0.1666));
}

/// The reference sample's older form: a packet for each message, T at the end.
TEST(VmcReceiver, SingleMessagesEndWithTimeOrState) {
  for (const char* end : {"/VMC/Ext/T", "/VMC/Ext/OK"}) {
    VmcReceiver receiver;
    EXPECT_FALSE(take(receiver, Packet().bone("Hips"), 0.0));
    EXPECT_FALSE(take(receiver, Packet().bone("Spine"), 0.001));
    EXPECT_TRUE(take(receiver, Packet().numbers(end, {1}), 0.002)) << end;
    EXPECT_TRUE(receiver.frame().pose.rotation[static_cast<std::size_t>(B::kSpine)]);
  }
}

TEST(VmcReceiver, ARepeatedBoneBeginsAFrame) {
  VmcReceiver receiver;
  EXPECT_FALSE(take(receiver, Packet().bone("Hips", {0, 1, 0, 0, 0, 0, 1}), 0.0));
  EXPECT_TRUE(take(receiver, Packet().bone("Hips", {0, 2, 0, 0, 0, 0, 1}), 0.005));
  EXPECT_EQ(receiver.frame().pose.offset[0].y(), 1.0);
}

TEST(VmcReceiver, AFrameEndsAfterOneNinetiethOfASecond) {
  VmcReceiver receiver;
  EXPECT_FALSE(take(receiver, Packet().bone("Hips"), 0.0));
  EXPECT_FALSE(receiver.wait(0.005));
  EXPECT_TRUE(receiver.wait(0.012));
  EXPECT_FALSE(receiver.wait(0.013));
}

/// A sender that stops sending fingers does not delay its frames for ever.
TEST(VmcReceiver, BonesThatAreNotSentAnyMoreAreForgotten) {
  VmcReceiver receiver;
  take(receiver, Packet().bundle().bone("Hips").bone("LeftIndexDistal"), 0.0);
  int complete = 0;
  for (int i = 1; i <= 60; ++i) complete += take(receiver, Packet().bundle().bone("Hips"), 0.02 * i);
  EXPECT_GT(complete, 55);
  EXPECT_TRUE(take(receiver, Packet().bundle().bone("Hips"), 1.21));
}

/// VMagicMirror: the root's name is empty, there is neither OK nor T.
TEST(VmcReceiver, ARootMayHaveAnyName) {
  for (const char* name : {"root", "", "Armature"}) {
    VmcReceiver receiver;
    EXPECT_TRUE(
        take(receiver, Packet().bundle().place("/VMC/Ext/Root/Pos", name, {1, 2, 3, 0, 0, 0, 1}).bone("Hips"), 0.0));
    EXPECT_TRUE(receiver.frame().pose.rootPosition.isApprox(Vec3(-1, 2, 3))) << name;
  }
}

/// The protocol's version 2.1 adds a scale and an offset for mixed reality, which are not used.
TEST(VmcReceiver, SurplusArgumentsAreIgnored) {
  VmcReceiver receiver;
  take(receiver,
       Packet().bundle().place("/VMC/Ext/Root/Pos", "root", {1, 0, 0, 0, 0, 0, 1, 9, 9, 9, 8, 8, 8}).bone("Hips"), 0.0);
  EXPECT_TRUE(receiver.frame().pose.rootPosition.isApprox(Vec3(-1, 0, 0)));
  EXPECT_EQ(receiver.refusedCount(), 0);
}

/// SlimeVR negates the whole quaternion.
TEST(VmcReceiver, ARotationAndItsNegativeAreTheSame) {
  VmcReceiver a;
  VmcReceiver b;
  take(a, Packet().bundle().bone("Hips", {0, 1, 0, 0.6f, 0, 0, 0.8f}), 0.0);
  take(b, Packet().bundle().bone("Hips", {0, 1, 0, -0.6f, 0, 0, -0.8f}), 0.0);
  EXPECT_LT(a.frame().pose.rotation[0]->angularDistance(*b.frame().pose.rotation[0]), 1e-6);
}

TEST(VmcReceiver, StateTellsWhetherTheSenderTracks) {
  const auto tracks = [](const std::vector<std::int32_t>& state) {
    VmcReceiver receiver;
    take(receiver, Packet().bundle().numbers("/VMC/Ext/OK", state).bone("Hips"), 0.0);
    return receiver.frame().tracking;
  };
  EXPECT_TRUE(tracks({1}));
  EXPECT_FALSE(tracks({0}));
  EXPECT_TRUE(tracks({1, 3, 0}));
  EXPECT_FALSE(tracks({1, 2, 0}));
  EXPECT_TRUE(tracks({1, 3, 0, 1}));
  EXPECT_FALSE(tracks({1, 3, 0, 0}));
}

/// Some senders say once, before the calibration, that they do not track yet.
TEST(VmcReceiver, AStateThatIsNotRepeatedPasses) {
  VmcReceiver once;
  VmcReceiver always;
  for (int i = 0; i < 60; ++i) {
    const double time = i / 30.0;
    Packet packet;
    packet.bundle();
    if (i == 0) packet.numbers("/VMC/Ext/OK", {0});
    take(once, packet.bone("Hips"), time);
    EXPECT_EQ(once.frame().tracking, time > 1.0) << time;
    take(always, Packet().bundle().numbers("/VMC/Ext/OK", {0}).bone("Hips"), time);
    EXPECT_FALSE(always.frame().tracking) << time;
  }
}

TEST(VmcReceiver, ExpressionsAreAppliedTogether) {
  VmcReceiver receiver;
  take(receiver, Packet().bundle().weight("Joy", 0.5f).weight("Blink", 2.0f), 0.0);
  ASSERT_EQ(receiver.expressions().size(), 2u);
  EXPECT_EQ(receiver.expressions()[0].weight, 0.0f);
  take(receiver, Packet().empty("/VMC/Ext/Blend/Apply"), 0.0);
  EXPECT_EQ(receiver.expressions()[0].name, "Joy");
  EXPECT_EQ(receiver.expressions()[0].weight, 0.5f);
  EXPECT_EQ(receiver.expressions()[1].weight, 1.0f);  // weights are at most 1
  EXPECT_TRUE(take(receiver, Packet().bundle().bone("Hips"), 0.01));
  EXPECT_EQ(receiver.frame().expressions, (std::vector<NamedWeight>{{"Joy", 0.5f}, {"Blink", 1.0f}}));
}

TEST(VmcReceiver, ExpressionsAreBounded) {
  VmcReceiver receiver;
  take(receiver, Packet().weight(std::string(kMaxExpressionName + 1, 'x'), 1.0f), 0.0);
  EXPECT_EQ(receiver.expressions().size(), 0u);
  take(receiver, Packet().weight(std::string(kMaxExpressionName, 'x'), 1.0f), 0.0);
  EXPECT_EQ(receiver.expressions().size(), 1u);
  for (std::size_t i = 1; i <= kMaxPoseExpressions; ++i) {
    take(receiver, Packet().weight("shape " + std::to_string(i), 1.0f), 0.0);
    EXPECT_EQ(receiver.expressions().size(), std::min(i + 1, kMaxPoseExpressions));
  }
}

TEST(VmcReceiver, BadNumbersAndUnknownBonesChangeNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  VmcReceiver receiver;
  take(receiver, Packet().bundle().bone("Hips", {0, 1, 0, 0, 0, 0, 1}), 0.0);
  const std::vector<std::vector<float>> bad = {
      {nan, 1, 0, 0, 0, 0, 1},
      {0, 1, 0, 0, 0, 0, 0},
      {0, 1, 0, inf, 0, 0, 1},
      {0, 1e6f, 0, 0, 0, 0, 1},
      {0, 1, 0, 0, 0, 0, 50},
      {0, 1, 0, 0, 0, 0},
      {},
  };
  for (const std::vector<float>& values : bad) {
    EXPECT_FALSE(take(receiver, Packet().bundle().bone("Hips", values), 0.1));
  }
  EXPECT_EQ(receiver.refusedCount(), static_cast<std::int64_t>(bad.size()));
  for (const char* name : {"LastBone", "Tail", "LeftEye", ""}) {
    EXPECT_FALSE(take(receiver, Packet().bundle().bone(name), 0.2)) << name;
  }
  EXPECT_TRUE(receiver.frame().pose.offset[0].isApprox(Vec3(0, 1, 0)));
}

TEST(VmcReceiver, PathsAreNotKeptAndTitlesAre) {
  VmcReceiver receiver;
  std::vector<std::byte> memory(256);
  OscWriter writer(memory);
  writer.beginMessage("/VMC/Ext/VRM", "ss");
  writer.add(std::string_view("/etc/passwd"));
  writer.add(std::string_view("Alicia"));
  writer.endMessage();
  receiver.take(writer.packet(), 0.0);
  EXPECT_EQ(receiver.title(), "Alicia");
}

}  // namespace
}  // namespace lorica
