#include "capture/streams/osc.h"

#include "capture/streams/tracker_writer.h"
#include "capture/streams/vmc_writer.h"
#include "geometry/random_numbers.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytesOf(std::string_view text) {
  Bytes bytes(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) bytes[i] = static_cast<std::byte>(text[i]);
  return bytes;
}

Bytes copyOf(std::span<const std::byte> packet) {
  return {packet.begin(), packet.end()};
}

/// The first example of the OSC 1.0 specification's page of examples.
const std::string kFrequency("/oscillator/4/frequency\0,f\0\0\x43\xdc\0\0", 32);
/// The second one: 1000, -1, "hello", 1.234, 5.678.
const std::string kFoo("/foo\0\0\0\0,iisff\0\0\0\0\x03\xe8\xff\xff\xff\xffhello\0\0\0\x3f\x9d\xf3\xb6\x40\xb5\xb2\x2d",
                       40);

/// Reads every message and every argument from memory of exactly the packet's size. @return the number of messages
int readAll(const Bytes& packet) {
  const auto memory = std::make_unique<std::byte[]>(packet.size());
  std::copy(packet.begin(), packet.end(), memory.get());
  OscPacket messages(std::span<const std::byte>(memory.get(), packet.size()));
  int count = 0;
  while (const std::optional<OscMessage> message = messages.next()) {
    ++count;
    OscArguments arguments(*message);
    while (arguments.left() > 0) {
      if (message->types[message->types.size() - arguments.left()] == 's') {
        (void)arguments.text();
      } else {
        (void)arguments.number();
      }
    }
  }
  return count;
}

TEST(Osc, TheSpecificationsExamplesAreRead) {
  const Bytes frequency = bytesOf(kFrequency);
  OscPacket packet(frequency);
  const std::optional<OscMessage> message = packet.next();
  ASSERT_TRUE(message);
  EXPECT_EQ(message->address, "/oscillator/4/frequency");
  OscArguments arguments(*message);
  EXPECT_EQ(arguments.number(), 440.0);
  EXPECT_FALSE(packet.next());
  EXPECT_FALSE(packet.malformed());
  EXPECT_FALSE(packet.isBundle());

  const Bytes foo = bytesOf(kFoo);
  OscPacket second(foo);
  OscArguments five(*second.next());
  EXPECT_EQ(five.left(), 5u);
  EXPECT_EQ(five.number(), 1000.0);
  EXPECT_EQ(five.number(), -1.0);
  EXPECT_EQ(five.text(), "hello");
  EXPECT_EQ(five.number(), static_cast<double>(1.234f));
  EXPECT_EQ(five.number(), static_cast<double>(5.678f));
  EXPECT_FALSE(five.number());
}

TEST(Osc, TheSpecificationsExamplesAreWritten) {
  std::array<std::byte, 64> memory{};
  OscWriter writer(memory);
  writer.beginMessage("/oscillator/4/frequency", "f");
  writer.add(440.0f);
  writer.endMessage();
  EXPECT_EQ(copyOf(writer.packet()), bytesOf(kFrequency));

  OscWriter second(memory);
  second.beginMessage("/foo", "iisff");
  second.add(std::int32_t{1000});
  second.add(std::int32_t{-1});
  second.add(std::string_view("hello"));
  second.add(1.234f);
  second.add(5.678f);
  second.endMessage();
  EXPECT_EQ(copyOf(second.packet()), bytesOf(kFoo));
}

TEST(Osc, NestedBundlesAreReadInOrder) {
  std::array<std::byte, 256> memory{};
  OscWriter inner(memory);
  inner.beginBundle();
  for (const char* address : {"/b", "/c"}) {
    inner.beginMessage(address, "");
    inner.endMessage();
  }
  const Bytes nested = copyOf(inner.packet());
  OscWriter outer(memory);
  outer.beginBundle();
  outer.beginMessage("/a", "");
  outer.endMessage();
  Bytes packet = copyOf(outer.packet());
  for (const std::size_t shift : {24u, 16u, 8u, 0u}) packet.push_back(static_cast<std::byte>(nested.size() >> shift));
  packet.insert(packet.end(), nested.begin(), nested.end());
  const Bytes last = bytesOf(std::string("\0\0\0\x08/d\0\0,\0\0\0", 12));
  packet.insert(packet.end(), last.begin(), last.end());

  OscPacket messages(packet);
  std::string addresses;
  while (const std::optional<OscMessage> message = messages.next()) addresses += message->address;
  EXPECT_EQ(addresses, "/a/b/c/d");
  EXPECT_FALSE(messages.malformed());
  EXPECT_TRUE(messages.isBundle());
}

TEST(Osc, BundlesNestedAThousandDeepAreRefused) {
  Bytes packet = bytesOf(kFrequency);
  for (int i = 0; i < 1000; ++i) {
    Bytes around = bytesOf(std::string("#bundle\0\0\0\0\0\0\0\0\x01", 16));
    for (const std::size_t shift : {24u, 16u, 8u, 0u}) around.push_back(static_cast<std::byte>(packet.size() >> shift));
    around.insert(around.end(), packet.begin(), packet.end());
    packet = std::move(around);
  }
  OscPacket messages(packet);
  EXPECT_FALSE(messages.next());
  EXPECT_TRUE(messages.malformed());
}

TEST(Osc, EveryTruncatedPrefixIsRefused) {
  for (const std::string& whole : {kFrequency, kFoo}) {
    for (std::size_t size = 1; size < whole.size(); ++size) {
      const Bytes packet = bytesOf(whole.substr(0, size));
      OscPacket messages(packet);
      const std::optional<OscMessage> message = messages.next();
      if (!message) {
        EXPECT_TRUE(messages.malformed()) << size;
        continue;
      }
      // The types promise more than there is.
      OscArguments arguments(*message);
      std::size_t read = 0;
      for (const char type : message->types)
        read += type == 's' ? arguments.text().has_value() : arguments.number().has_value();
      EXPECT_LT(read, message->types.empty() ? 1 : message->types.size()) << size;
    }
  }
}

/// Types that make other readers believe a size: two blobs of 4 GB, strings without an end, unknown letters.
TEST(Osc, PromisesThatThePacketDoesNotHoldAreNotBelieved) {
  EXPECT_EQ(readAll(bytesOf(std::string("/a\0\0,bb\0\x7f\xff\xff\xf0", 12))), 1);
  EXPECT_EQ(readAll(bytesOf(std::string("/a\0\0,ss\0abcdefgh", 16))), 1);
  EXPECT_EQ(readAll(bytesOf(std::string("/a\0\0,\xff\xfe\0", 8))), 1);
  EXPECT_EQ(readAll(bytesOf("/abc,def")), 0);
  EXPECT_EQ(readAll(bytesOf("nothing of the kind.")), 0);
  EXPECT_EQ(readAll(bytesOf(std::string("#bundle\0\0\0\0\0\0\0\0\x01\xff\xff\xff\xff", 20))), 0);
}

TEST(Osc, NumbersOfAllSizesAreRead) {
  // "/n" with a double of 0.1, an integer of 64 bits of -2, true and false, and a double whose end is missing.
  const std::string packet("/n\0\0,dhTFd\0\0\x3f\xb9\x99\x99\x99\x99\x99\x9a\xff\xff\xff\xff\xff\xff\xff\xfe\0\0\0\0",
                           32);
  OscPacket messages(std::as_bytes(std::span(packet)));
  const std::optional<OscMessage> message = messages.next();
  ASSERT_TRUE(message);
  OscArguments arguments(*message);
  for (const double expected : {0.1, -2.0, 1.0, 0.0}) EXPECT_EQ(arguments.number(), expected);
  EXPECT_FALSE(arguments.number());
}

TEST(Osc, NumbersThatAreNotFiniteAreNotRead) {
  const Bytes packet = bytesOf(std::string("/a\0\0,ff\0\x7f\xc0\0\0\x3f\x80\0\0", 16));
  OscPacket messages(packet);
  OscArguments arguments(*messages.next());
  EXPECT_FALSE(arguments.number());
  EXPECT_FALSE(arguments.number());
}

TEST(Osc, RandomlyChangedBundlesAreReadWithoutLeavingThem) {
  std::array<std::byte, 512> memory{};
  OscWriter writer(memory);
  writer.beginBundle();
  for (int i = 0; i < 4; ++i) {
    writer.beginMessage("/VMC/Ext/Bone/Pos", "sfffffff");
    writer.add(std::string_view("LeftUpperArm"));
    for (int k = 0; k < 7; ++k) writer.add(0.5f);
    writer.endMessage();
  }
  const Bytes whole = copyOf(writer.packet());
  ASSERT_EQ(readAll(whole), 4);
  RandomNumbers random(7);
  for (int trial = 0; trial < 20000; ++trial) {
    Bytes packet = whole;
    const int changes = 1 + static_cast<int>(random.between(0.0, 6.0));
    for (int i = 0; i < changes; ++i) {
      const auto at = static_cast<std::size_t>(random.unit() * static_cast<double>(packet.size()));
      packet[at] = static_cast<std::byte>(static_cast<int>(random.between(0.0, 256.0)));
    }
    EXPECT_LE(readAll(packet), 40);
  }
}

TEST(Osc, WhatDoesNotFitIsNotWritten) {
  std::array<std::byte, 40> memory{};
  OscWriter writer(memory);
  writer.beginBundle();
  writer.beginMessage("/a", "f");
  writer.add(1.0f);
  writer.endMessage();
  EXPECT_TRUE(writer.fits());
  writer.beginMessage("/much/too/long/for/this", "f");
  writer.add(1.0f);
  writer.endMessage();
  EXPECT_FALSE(writer.fits());
}

struct Heard {
  std::string address, text;
  double strength = 0.0;
};

Heard heard(const SentContact& contact) {
  ContactWriter writer;
  OscPacket packet(writer.write(contact));
  const std::optional<OscMessage> message = packet.next();
  if (!message || message->types != "sf") return {};
  OscArguments arguments(*message);
  Heard result{std::string(message->address), std::string(arguments.text().value_or("")), 0.0};
  result.strength = arguments.number().value_or(-1.0);
  EXPECT_FALSE(packet.next());
  EXPECT_FALSE(packet.malformed());
  return result;
}

TEST(ContactWriter, NamesBonePropPlaceAndStrength) {
  const Heard message = heard({"begin", "RightHand", "", 2, {-0.21, 1.34, 0.52}, 1.75});
  EXPECT_EQ(message.address, "/VMC/Thru/lorica/contact/begin");
  EXPECT_EQ(message.text, "RightHand prop:2 0.210 1.340 0.520");
  EXPECT_EQ(message.strength, 1.75);
}

TEST(ContactWriter, NamesBothBones) {
  const Heard message = heard({"end", "LeftThumbProximal", "RightThumbProximal", 0, {0.0, 1.0, -0.25}, 0.0});
  EXPECT_EQ(message.address, "/VMC/Thru/lorica/contact/end");
  EXPECT_EQ(message.text, "LeftThumbProximal RightThumbProximal -0.000 1.000 -0.250");
}

TEST(ContactWriter, PlacesBeyondMeasureAreCutShort) {
  const Heard message = heard({"stay", "Hips", "", 1, {1e200, 1e200, 1e200}, 0.5});
  EXPECT_EQ(message.text.size(), 128u);
  EXPECT_EQ(message.strength, 0.5);
}

constexpr double kRadians = std::numbers::pi / 180.0;

Quat about(const Vec3& axis, double degrees) {
  return Quat(Eigen::AngleAxisd(kRadians * degrees, axis));
}

std::map<std::string, Vec3> decoded(std::span<const std::byte> bytes) {
  std::map<std::string, Vec3> vectors;
  OscPacket packet(bytes);
  while (const std::optional<OscMessage> message = packet.next()) {
    EXPECT_EQ(message->types, "fff");
    OscArguments arguments(*message);
    Vec3 v;
    for (double& value : v) value = arguments.number().value();
    vectors[std::string(message->address)] = v;
  }
  EXPECT_FALSE(packet.malformed());
  return vectors;
}

/// Unity: "a rotation of z degrees around the z axis, x degrees around the x axis, and y degrees around the y axis, in
/// that order".
TEST(TrackerWriter, AnglesAreAppliedInUnitysOrder) {
  RandomNumbers random(3);
  for (int i = 0; i < 1000; ++i) {
    Quat q;
    for (double& value : q.coeffs()) value = random.between(-1.0, 1.0);
    q.normalize();
    const Vec3 angles = unityAngles(q);
    const Quat again =
        about(Vec3::UnitY(), angles.y()) * about(Vec3::UnitX(), angles.x()) * about(Vec3::UnitZ(), angles.z());
    EXPECT_LT(again.angularDistance(q), 1e-6) << q.coeffs().transpose();
  }
  for (const double x : {90.0, -90.0}) {
    const Quat q = about(Vec3::UnitY(), 30.0) * about(Vec3::UnitX(), x);
    const Vec3 angles = unityAngles(q);
    const Quat again = about(Vec3::UnitY(), angles.y()) * about(Vec3::UnitX(), angles.x());
    EXPECT_LT(again.angularDistance(q), 1e-6);
  }
}

TEST(TrackerWriter, TheBodyIsScaledToTheUserAndMirrored) {
  const Character mannequin = makeMannequin();
  BonePoseReader reader = test::valueOf(BonePoseReader::create(mannequin.skeleton));
  const Pose rest = restPose(mannequin.skeleton);
  const BonePose pose = reader.read(rest);
  std::vector<Affine3> worldFromJoint(rest.size());
  computeWorldFromJoint(mannequin.skeleton, rest, worldFromJoint);
  TrackerWriter writer(TrackerReceiver::kVrchat, mannequin.height);
  const std::map<std::string, Vec3> sent = decoded(writer.write(pose));
  EXPECT_EQ(sent.size(), 18u);
  const auto expected = [&](HumanBone bone) {
    Vec3 p = 1.7 / mannequin.height * worldFromJoint[mannequin.skeleton.jointOf(bone)].translation();
    p.x() = -p.x();  // Unity is left-handed
    return p;
  };
  const std::map<std::string, HumanBone> places = {{"head", HumanBone::kHead},      {"1", HumanBone::kHips},
                                                   {"3", HumanBone::kLeftFoot},     {"6", HumanBone::kRightLowerLeg},
                                                   {"7", HumanBone::kLeftLowerArm}, {"2", HumanBone::kChest}};
  for (const auto& [name, bone] : places) {
    const Vec3& p = sent.at("/tracking/trackers/" + name + "/position");
    EXPECT_LT((p - expected(bone)).norm(), 1e-6) << name;
    EXPECT_LT(sent.at("/tracking/trackers/" + name + "/rotation").norm(), 1e-3) << name;  // a T-pose
  }
}

TEST(TrackerWriter, AWearerIsSentInTheirStage) {
  const Character mannequin = makeMannequin();
  BonePoseReader reader = BonePoseReader::create(mannequin.skeleton).value();
  StagedPerson person;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) person.joints.joints[j] = {Vec3(0.1 * j, 1.0, -0.2 * j), {}, 0.6};
  person.joints[BodyJoint::kLeftElbow].confidence = 0.0;
  person.stageFromWorld = Eigen::Translation3d(1.0, 0.02, 3.0) * about(Vec3::UnitY(), 40.0);
  const std::map<std::string, Vec3> sent = decoded(TrackerWriter(TrackerReceiver::kVrchat, mannequin.height)
                                                       .write(reader.read(restPose(mannequin.skeleton)), &person));
  EXPECT_EQ(sent.size(), 16U) << "an elbow is not known";
  const auto at = [&](BodyJoint joint) { return person.joints[joint].position; };
  const std::map<std::string, Vec3> places = {
      {"head", at(BodyJoint::kHead)},
      {"1", 0.5 * (at(BodyJoint::kLeftHip) + at(BodyJoint::kRightHip))},
      {"4", at(BodyJoint::kRightFoot)},
      {"8", at(BodyJoint::kRightElbow)},
  };
  for (const auto& [name, place] : places) {
    Vec3 expected = person.stageFromWorld * place;
    expected.x() = -expected.x();
    EXPECT_LT((sent.at("/tracking/trackers/" + name + "/position") - expected).norm(), 1e-6) << name;
    // A T-pose turned by 40 degrees to its left.
    const Vec3 angles = sent.at("/tracking/trackers/" + name + "/rotation");
    EXPECT_LT((angles - Vec3(0.0, -40.0, 0.0)).norm(), 1e-3) << name;
  }
}

TEST(TrackerWriter, OnlyTheTrackersAskedForAreSent) {
  const Character mannequin = makeMannequin();
  BonePoseReader reader = test::valueOf(BonePoseReader::create(mannequin.skeleton));
  const BonePose pose = reader.read(restPose(mannequin.skeleton));
  const std::map<std::string_view, std::vector<std::string>> numbers = {{"head", {"head"}},    {"waist", {"1"}},
                                                                        {"chest", {"2"}},      {"feet", {"3", "4"}},
                                                                        {"knees", {"5", "6"}}, {"elbows", {"7", "8"}}};
  for (std::size_t group = 0; group < kTrackerGroups.size(); ++group) {
    TrackerWriter writer(TrackerReceiver::kVrchat, mannequin.height, TrackerGroups().set(group));
    const std::vector<std::string>& expected = numbers.at(kTrackerGroups[group]);
    const std::map<std::string, Vec3> sent = decoded(writer.write(pose));
    EXPECT_EQ(sent.size(), 2 * expected.size());
    for (const std::string& number : expected) {
      EXPECT_TRUE(sent.contains("/tracking/trackers/" + number + "/position"));
      EXPECT_TRUE(sent.contains("/tracking/trackers/" + number + "/rotation"));
    }
  }
}

/// Turned to its left, towards +X here, the body faces -X in Unity: a yaw of -90 degrees.
TEST(TrackerWriter, ATurnIsAYaw) {
  BonePoseReader reader = test::valueOf(BonePoseReader::create(makeMannequin().skeleton));
  BonePose pose = reader.read(restPose(makeMannequin().skeleton));
  pose.rootRotation = about(Vec3::UnitY(), 90.0);
  TrackerWriter writer(TrackerReceiver::kVrchat, 1.7);
  const Vec3 yaw = decoded(writer.write(pose)).at("/tracking/trackers/1/rotation");
  EXPECT_LT((yaw - Vec3(0, -90, 0)).norm(), 1e-3) << yaw.transpose();
}

/// Virtual Motion Tracker: an index, a mode and a time offset, then position and quaternion in Unity's axes.
TEST(TrackerWriter, VirtualMotionTrackerHearsQuaternions) {
  const Character mannequin = makeMannequin();
  BonePoseReader reader = test::valueOf(BonePoseReader::create(mannequin.skeleton));
  BonePose pose = reader.read(restPose(mannequin.skeleton));
  pose.rootRotation = about(Vec3::UnitY(), 40.0) * about(Vec3::UnitX(), 10.0);
  const auto read = [](std::span<const std::byte> bytes) {
    std::map<int, std::vector<double>> trackers;
    OscPacket packet(bytes);
    while (const std::optional<OscMessage> message = packet.next()) {
      EXPECT_EQ(message->address, "/VMT/Room/Unity");
      EXPECT_EQ(message->types, "iiffffffff");
      OscArguments arguments(*message);
      const int index = static_cast<int>(arguments.number().value());
      while (const std::optional<double> number = arguments.number()) trackers[index].push_back(*number);
      EXPECT_EQ(trackers[index].size(), 9U);
    }
    EXPECT_FALSE(packet.malformed());
    return trackers;
  };
  TrackerWriter vrchat(TrackerReceiver::kVrchat, mannequin.height);
  const std::map<std::string, Vec3> same = decoded(vrchat.write(pose));
  TrackerWriter writer(TrackerReceiver::kVmt, mannequin.height);
  EXPECT_TRUE(writer.writeEnd().empty()) << "nothing was switched on";
  const std::map<int, std::vector<double>> sent = read(writer.write(pose));
  ASSERT_EQ(sent.size(), 8U) << "all but the head";
  for (const auto& [index, numbers] : sent) {
    ASSERT_TRUE(index >= 1 && index <= 8);
    EXPECT_EQ(numbers[0], 1.0) << "a tracker";
    EXPECT_EQ(numbers[1], 0.0) << "of now";
    const std::string address = "/tracking/trackers/" + std::to_string(index);
    EXPECT_LT((Vec3(numbers[2], numbers[3], numbers[4]) - same.at(address + "/position")).norm(), 1e-6) << index;
    const Vec3 angles = same.at(address + "/rotation");
    const Quat turn =
        about(Vec3::UnitY(), angles.y()) * about(Vec3::UnitX(), angles.x()) * about(Vec3::UnitZ(), angles.z());
    EXPECT_LT(turn.angularDistance(Quat(numbers[8], numbers[5], numbers[6], numbers[7])), 1e-5) << index;
  }
  const std::map<int, std::vector<double>> ended = read(writer.writeEnd());
  EXPECT_EQ(ended.size(), sent.size());
  for (const auto& [index, numbers] : ended) EXPECT_EQ(numbers[0], 0.0) << index;
  EXPECT_TRUE(writer.writeEnd().empty());
  TrackerWriter feet(TrackerReceiver::kVmt, mannequin.height, TrackerGroups(0b001001));
  const std::map<int, std::vector<double>> few = read(feet.write(pose));
  EXPECT_TRUE(few.size() == 2 && few.contains(3) && few.contains(4)) << "never the head";
}

}  // namespace
}  // namespace lorica
