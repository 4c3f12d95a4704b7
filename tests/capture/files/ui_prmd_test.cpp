#include "capture/files/joint_stream.h"
#include "capture/retarget/retarget.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/figures.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lorica {
namespace {

using J = BodyJoint;
using B = HumanBone;

/// A skeleton of round numbers [cm] in UI-PRMD's order, with zero angles except the requested ones.
std::string offsetsRow() {
  std::string row;
  for (const char* offset : {"1,90,-240", "0,25,0", "0,20,0", "0,1,0",   "0,6,0",   "0,14,0",  "2,0,0", "15,0,0",
                             "28,0,0",    "25,0,0", "-2,0,0", "-15,0,0", "-28,0,0", "-25,0,0", "8,0,0", "0,-40,0",
                             "0,-41,0",   "0,0,14", "-8,0,0", "0,-40,0", "0,-41,0", "0,0,14"}) {
    row += fmt::format("{}{}", row.empty() ? "" : ",", offset);
  }
  return row + "\n";
}

std::string anglesRow(std::size_t joint, const std::string& xyz) {
  std::string row;
  for (std::size_t j = 0; j < 22; ++j) row += fmt::format("{}{}", j == 0 ? "" : ",", j == joint ? xyz : "0,0,0");
  return row + "\n";
}

TEST(UiPrmd, ZeroAnglesAreATPoseThatFacesPlusZ) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("a_positions.txt", offsetsRow() + offsetsRow() + offsetsRow());
  // Row 2: the left upper arm up by 90 degrees about Z. Row 3: the left thigh 90 degrees forward about X.
  folder.write("a_angles.txt", anglesRow(0, "0,0,0") + anglesRow(7, "0,0,90") + anglesRow(14, "-90,0,0"));
  const auto stream = test::valueOf(readJointStream(file));
  EXPECT_EQ(stream.format, JointFormat::kUiPrmd);
  ASSERT_EQ(stream.frames.size(), 3u);
  const auto from = [&](std::size_t f, J a, J b) -> Vec3 {
    return stream.frames[f][b].position - stream.frames[f][a].position;
  };
  EXPECT_LT((from(0, J::kLeftShoulder, J::kLeftHand) - Vec3(0.53, 0, 0)).norm(), 1e-12);
  EXPECT_LT((from(0, J::kRightShoulder, J::kRightHand) - Vec3(-0.53, 0, 0)).norm(), 1e-12);
  EXPECT_LT((from(0, J::kLeftHip, J::kLeftFoot) - Vec3(0, -0.81, 0)).norm(), 1e-12);
  EXPECT_LT((from(0, J::kTorso, J::kNeck) - Vec3(0, 0.21, 0)).norm(), 1e-12);
  EXPECT_LT((from(0, J::kNeck, J::kHead) - Vec3(0, 0.13, 0)).norm(), 1e-12);
  EXPECT_NEAR(stream.frames[0][J::kLeftFoot].position.y(), 0.08, 1e-12);
  EXPECT_LT((from(1, J::kLeftShoulder, J::kLeftHand) - Vec3(0, 0.53, 0)).norm(), 1e-12);
  EXPECT_LT((from(2, J::kLeftHip, J::kLeftFoot) - Vec3(0, 0, 0.81)).norm(), 1e-12);
  EXPECT_LT(stream.frames[0][J::kTorso].orientation->angularDistance(Quat::Identity()), 1e-12);
}

TEST(UiPrmd, AnglesTurnAboutYThenXThenZ) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("a_positions.txt", offsetsRow());
  folder.write("a_angles.txt", anglesRow(7, "20,30,40"));
  const auto stream = test::valueOf(readJointStream(file));
  const auto degrees = [](double d) { return test::degrees(d); };
  // Computed by hand: (1, 0, 0) about Y by 30, then about X by 20, then about Z by 40 degrees.
  const Vec3 y(std::cos(degrees(30)), 0, -std::sin(degrees(30)));
  const Vec3 x(y.x(), -std::sin(degrees(20)) * y.z(), std::cos(degrees(20)) * y.z());
  const Vec3 z(std::cos(degrees(40)) * x.x() - std::sin(degrees(40)) * x.y(),
               std::sin(degrees(40)) * x.x() + std::cos(degrees(40)) * x.y(), x.z());
  const SkeletonFrame& frame = stream.frames[0];
  EXPECT_LT((frame[J::kLeftHand].position - frame[J::kLeftShoulder].position - 0.53 * z).norm(), 1e-12);
}

TEST(UiPrmd, JointsThatAreNotKnownAndThoseThatHangOnThemAreNotSeen) {
  const test::TemporaryFolder folder;
  std::string noElbow;
  for (std::size_t j = 0; j < 22; ++j)
    noElbow += fmt::format("{}{}", j == 0 ? "" : ",", j == 8 ? "NaN,nan,NaN" : "0,5,0");
  const auto file = folder.write("a_positions.txt", offsetsRow() + noElbow + "\n" + offsetsRow());
  // Row 3: the angle of the right knee is missing, so the foot's position is unknown.
  folder.write("a_angles.txt", anglesRow(0, "0,0,0") + anglesRow(0, "0,0,0") + anglesRow(19, "0,,0"));
  const auto stream = test::valueOf(readJointStream(file));
  ASSERT_EQ(stream.frames.size(), 3u);
  const auto unseen = [&](std::size_t f) {
    std::vector<J> joints;
    for (int j = 0; j < kBodyJointCount; ++j) {
      const TrackedJoint& joint = stream.frames[f][static_cast<J>(j)];
      EXPECT_TRUE(joint.position.allFinite());
      if (joint.confidence == 0.0) joints.push_back(static_cast<J>(j));
    }
    return joints;
  };
  EXPECT_EQ(unseen(0), std::vector<J>());
  EXPECT_EQ(unseen(1), (std::vector<J>{J::kLeftElbow, J::kLeftHand}));
  EXPECT_EQ(unseen(2), (std::vector<J>{J::kRightFoot}));
}

double heightOf(const SkeletonFrame& frame, J joint) {
  return frame[joint].position.y();
}

TEST(UiPrmd, ADeepSquatLooksLikeOne) {
  LORICA_REQUIRE_DATASET(file, "joints/ui_prmd/m01_s01_e01_positions.txt");
  const auto stream = test::valueOf(readJointStream(file));
  EXPECT_EQ(stream.frames.size(), 73u);
  double lowestHead = 9.0, highestHead = 0.0;
  for (const SkeletonFrame& frame : stream.frames) {
    lowestHead = std::min(lowestHead, heightOf(frame, J::kHead));
    highestHead = std::max(highestHead, heightOf(frame, J::kHead));
    // The exercise requires arms overhead throughout; feet stay on the floor except for the sensor's noise.
    EXPECT_GT(heightOf(frame, J::kLeftHand), heightOf(frame, J::kHead) + 0.1);
    EXPECT_GT(heightOf(frame, J::kRightHand), heightOf(frame, J::kHead) + 0.1);
    EXPECT_LT(heightOf(frame, J::kLeftFoot), 0.2);
    EXPECT_GT(heightOf(frame, J::kLeftFoot), 0.05);
    // Knees bend to the front, which is +Z.
    const Vec3 middle = 0.5 * (frame[J::kLeftHip].position + frame[J::kLeftFoot].position);
    EXPECT_GT(frame[J::kLeftKnee].position.z() - middle.z(), 0.0);
    EXPECT_GT(frame[J::kLeftHip].position.x() - frame[J::kRightHip].position.x(), 0.08);
    // In the dataset bones stretch by several centimetres.
    EXPECT_NEAR((frame[J::kLeftElbow].position - frame[J::kLeftShoulder].position).norm(), 0.26, 0.03);
  }
  EXPECT_GT(highestHead - lowestHead, 0.5);
}

TEST(UiPrmd, AbductionLiftsOneStraightArmOverTheHead) {
  LORICA_REQUIRE_DATASET(file, "joints/ui_prmd/m07_s01_e01_positions.txt");
  const auto stream = test::valueOf(readJointStream(file));
  double highest = -9.0, lowest = 9.0;
  for (const SkeletonFrame& frame : stream.frames) {
    const double hand =
        std::max(heightOf(frame, J::kLeftHand), heightOf(frame, J::kRightHand)) - heightOf(frame, J::kHead);
    highest = std::max(highest, hand);
    lowest = std::min(lowest, hand);
  }
  EXPECT_GT(highest, 0.25);
  EXPECT_LT(lowest, -0.5);
}

TEST(UiPrmd, TheMannequinDoesTheExercises) {
  LORICA_REQUIRE_DATASET(squat, "joints/ui_prmd/m01_s01_e01_positions.txt");
  const Character mannequin = makeMannequin();
  const Skeleton& skeleton = mannequin.skeleton;
  for (const char* name : {"m01", "m02", "m04", "m07", "m10"}) {
    SCOPED_TRACE(name);
    const auto stream =
        test::valueOf(readJointStream(squat.parent_path() / fmt::format("{}_s01_e01_positions.txt", name)));
    Retargeter retargeter = *Retargeter::create(skeleton);
    Pose pose(static_cast<std::size_t>(skeleton.jointCount()));
    for (const SkeletonFrame& frame : stream.frames) {
      retargeter.apply(frame, pose);
      const std::vector<Affine3> world = test::worldOf(skeleton, pose);
      const auto at = [&](B bone) -> Vec3 { return world[skeleton.jointOf(bone)].translation(); };
      const Vec3 arm = frame[J::kLeftElbow].position - frame[J::kLeftShoulder].position;
      EXPECT_LT(test::angleBetween(at(B::kLeftLowerArm) - at(B::kLeftUpperArm), arm), test::degrees(0.5));
      const Vec3 thigh = frame[J::kRightKnee].position - frame[J::kRightHip].position;
      // Legs may bend to keep a standing foot in position.
      EXPECT_LT(test::angleBetween(at(B::kRightLowerLeg) - at(B::kRightUpperLeg), thigh), test::degrees(15.0));
      // No backward knee: the shin never points further to the front than the thigh does.
      const Vec3 left = at(B::kLeftUpperLeg) - at(B::kRightUpperLeg);
      const Vec3 upper = at(B::kRightLowerLeg) - at(B::kRightUpperLeg);
      const Vec3 lower = at(B::kRightFoot) - at(B::kRightLowerLeg);
      EXPECT_GT(upper.cross(lower).dot(left) / (upper.norm() * lower.norm() * left.norm()), -0.05);
    }
  }
}

}  // namespace
}  // namespace lorica
