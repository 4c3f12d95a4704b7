#include "capture/streams/vrchat_writer.h"

#include "capture/streams/osc.h"
#include "geometry/random_numbers.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <string>

namespace lorica {
namespace {

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
TEST(VrchatWriter, AnglesAreAppliedInUnitysOrder) {
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

TEST(VrchatWriter, TheBodyIsScaledToTheUserAndMirrored) {
  const Character mannequin = makeMannequin();
  BonePoseReader reader = test::valueOf(BonePoseReader::create(mannequin.skeleton));
  const Pose rest = restPose(mannequin.skeleton);
  const BonePose pose = reader.read(rest);
  std::vector<Affine3> worldFromJoint(rest.size());
  computeWorldFromJoint(mannequin.skeleton, rest, worldFromJoint);
  VrchatWriter writer(mannequin.height);
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

TEST(VrchatWriter, AWearerIsSentInTheirStage) {
  const Character mannequin = makeMannequin();
  BonePoseReader reader = BonePoseReader::create(mannequin.skeleton).value();
  StagedPerson person;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) person.joints.joints[j] = {Vec3(0.1 * j, 1.0, -0.2 * j), {}, 0.6};
  person.joints[BodyJoint::kLeftElbow].confidence = 0.0;
  person.stageFromWorld = Eigen::Translation3d(1.0, 0.02, 3.0) * about(Vec3::UnitY(), 40.0);
  const std::map<std::string, Vec3> sent =
      decoded(VrchatWriter(mannequin.height).write(reader.read(restPose(mannequin.skeleton)), &person));
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

TEST(VrchatWriter, OnlyTheTrackersAskedForAreSent) {
  const Character mannequin = makeMannequin();
  BonePoseReader reader = test::valueOf(BonePoseReader::create(mannequin.skeleton));
  const BonePose pose = reader.read(restPose(mannequin.skeleton));
  const std::map<std::string_view, std::vector<std::string>> numbers = {{"head", {"head"}},    {"waist", {"1"}},
                                                                        {"chest", {"2"}},      {"feet", {"3", "4"}},
                                                                        {"knees", {"5", "6"}}, {"elbows", {"7", "8"}}};
  for (std::size_t group = 0; group < kVrchatTrackers.size(); ++group) {
    VrchatWriter writer(mannequin.height, VrchatTrackers().set(group));
    const std::vector<std::string>& expected = numbers.at(kVrchatTrackers[group]);
    const std::map<std::string, Vec3> sent = decoded(writer.write(pose));
    EXPECT_EQ(sent.size(), 2 * expected.size());
    for (const std::string& number : expected) {
      EXPECT_TRUE(sent.contains("/tracking/trackers/" + number + "/position"));
      EXPECT_TRUE(sent.contains("/tracking/trackers/" + number + "/rotation"));
    }
  }
}

/// Turned to its left, towards +X here, the body faces -X in Unity: a yaw of -90 degrees.
TEST(VrchatWriter, ATurnIsAYaw) {
  BonePoseReader reader = test::valueOf(BonePoseReader::create(makeMannequin().skeleton));
  BonePose pose = reader.read(restPose(makeMannequin().skeleton));
  pose.rootRotation = about(Vec3::UnitY(), 90.0);
  VrchatWriter writer(1.7);
  const Vec3 yaw = decoded(writer.write(pose)).at("/tracking/trackers/1/rotation");
  EXPECT_LT((yaw - Vec3(0, -90, 0)).norm(), 1e-3) << yaw.transpose();
}

}  // namespace
}  // namespace lorica
