
#include "capture/files/joint_csv.h"
#include "capture/sensor/oni_file.h"
#include "capture/virtual_sensor/virtual_performer.h"
#include "capture/virtual_sensor/virtual_script.h"
#include "geometry/tri_mesh.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/bench/virtual_furniture.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace lorica {
namespace {

using B = HumanBone;

std::vector<Affine3> restOf(const Character& character) {
  std::vector<Affine3> worldFromJoint(static_cast<std::size_t>(character.skeleton.jointCount()));
  computeWorldFromJoint(character.skeleton, restPose(character.skeleton), worldFromJoint);
  return worldFromJoint;
}

Vec3 positionOf(const Character& character, B bone) {
  return restOf(character)[character.skeleton.jointOf(bone)].translation();
}

double lengthOf(const Character& character, B from, B to) {
  return (positionOf(character, from) - positionOf(character, to)).norm();
}

TEST(VirtualBody, FactorsOfOneChangeNothing) {
  const Character mannequin = makeMannequin();
  const Character same = withProportions(mannequin, {});
  for (std::size_t v = 0; v < mannequin.mesh.vertices.size(); ++v) {
    ASSERT_NEAR((mannequin.mesh.vertices[v] - same.mesh.vertices[v]).norm(), 0.0, 1e-12);
  }
  EXPECT_NEAR(same.height, mannequin.height, 1e-12);
}

TEST(VirtualBody, HeightScalesEverything) {
  const Character mannequin = makeMannequin();
  const Character taller = withProportions(mannequin, {.height = 1.1});
  EXPECT_NEAR(taller.height, 1.1 * mannequin.height, 1e-9);
  EXPECT_NEAR(signedVolume(taller.mesh.vertices, taller.mesh.triangles),
              1.331 * signedVolume(mannequin.mesh.vertices, mannequin.mesh.triangles), 1e-9);
  for (const B bone : {B::kHead, B::kLeftHand, B::kRightFoot, B::kHips}) {
    EXPECT_NEAR((positionOf(taller, bone) - 1.1 * positionOf(mannequin, bone)).norm(), 0.0, 1e-9);
  }
}

TEST(VirtualBody, GirthMovesTheSkinAndNoJoint) {
  const Character mannequin = makeMannequin();
  const Character heavier = withProportions(mannequin, {.girth = 1.3});
  for (const B bone : {B::kHead, B::kLeftHand, B::kRightFoot, B::kHips, B::kLeftUpperArm}) {
    EXPECT_NEAR((positionOf(heavier, bone) - positionOf(mannequin, bone)).norm(), 0.0, 0.003);
  }
  const double ratio = signedVolume(heavier.mesh.vertices, heavier.mesh.triangles) /
                       signedVolume(mannequin.mesh.vertices, mannequin.mesh.triangles);
  EXPECT_GT(ratio, 1.3);
  EXPECT_LT(ratio, 1.69);
}

TEST(VirtualBody, LimbsAndTrunkScaleByTheirFactors) {
  const Character mannequin = makeMannequin();
  const Character other = withProportions(mannequin, {.arms = 0.85, .legs = 1.15, .trunk = 1.1});
  for (const auto& [from, to, factor] : {std::tuple{B::kLeftUpperArm, B::kLeftLowerArm, 0.85},
                                         {B::kRightLowerArm, B::kRightHand, 0.85},
                                         {B::kLeftUpperLeg, B::kLeftLowerLeg, 1.15},
                                         {B::kRightLowerLeg, B::kRightFoot, 1.15},
                                         {B::kSpine, B::kChest, 1.1},
                                         {B::kNeck, B::kHead, 1.0},
                                         {B::kLeftFoot, B::kLeftToes, 1.0}}) {
    EXPECT_NEAR(lengthOf(other, from, to), factor * lengthOf(mannequin, from, to), 1e-9);
  }
  const auto lowest = [](const Character& c) { return boundsOf(c.mesh.vertices).min.y(); };
  EXPECT_NEAR(lowest(other), lowest(mannequin), 1e-9);
}

TEST(VirtualBody, AChangedBodyIsWholeAndItsRestPoseIsItsBindPose) {
  const Character other =
      withProportions(makeMannequin(), {.height = 0.9, .girth = 1.2, .arms = 1.1, .legs = 0.9, .trunk = 1.05});
  ASSERT_TRUE(checkCharacter(other).ok());
  EXPECT_TRUE(checkClosedTwoManifold(other.mesh).ok());
  std::vector<Affine3> worldFromModel = restOf(other);
  computeWorldFromModel(other, worldFromModel, worldFromModel);
  std::vector<Vec3> posed(other.mesh.vertices.size());
  skinLinearBlend(other, worldFromModel, posed);
  for (std::size_t v = 0; v < posed.size(); ++v) ASSERT_NEAR((posed[v] - other.mesh.vertices[v]).norm(), 0.0, 1e-9);
  EXPECT_NEAR(other.height, boundsOf(posed).max.y() - boundsOf(posed).min.y(), 1e-9);
}

/// All kinds with many seeds; seats last.
template <typename Act>
void eachPiece(const Act& act) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (int kind = 0; kind <= kFurnitureKindCount; ++kind) {
      RandomNumbers random(100 * seed + static_cast<std::uint64_t>(kind));
      const bool seat = kind == kFurnitureKindCount;
      act(seat ? makeSeat(0.45, random) : makeFurniture(static_cast<FurnitureKind>(kind), random), kind);
    }
  }
}

TEST(VirtualFurniture, StandsOnTheFloorWithinAHumanRoom) {
  eachPiece([](const Furniture& piece, int kind) {
    SCOPED_TRACE(kind);
    ASSERT_FALSE(piece.triangles.empty());
    double low = 1e9, high = -1e9;
    for (const Vec3& position : piece.positions) {
      ASSERT_TRUE(position.allFinite());
      low = std::min(low, position.y());
      high = std::max(high, position.y());
    }
    EXPECT_LT(low, 0.45);
    EXPECT_GT(low, -0.6);
    EXPECT_GT(high, 0.2);
    EXPECT_LT(high, 2.6);
    for (const Triangle& triangle : piece.triangles) {
      for (const int corner : triangle) {
        ASSERT_GE(corner, 0);
        ASSERT_LT(static_cast<std::size_t>(corner), piece.positions.size());
      }
    }
  });
}

TEST(VirtualFurniture, TheSameNumbersGiveTheSamePiece) {
  std::vector<std::vector<Vec3>> first, second;
  eachPiece([&](const Furniture& piece, int) { first.push_back(piece.positions); });
  eachPiece([&](const Furniture& piece, int) { second.push_back(piece.positions); });
  EXPECT_EQ(first, second);
}

TEST(VirtualFurniture, IsMovedRigidly) {
  eachPiece([](const Furniture& piece, int kind) {
    SCOPED_TRACE(kind);
    Furniture placed = piece;
    placed.place({1.0, 0.0, -2.0}, 0.7);
    for (std::size_t v = 1; v < piece.positions.size(); ++v) {
      const double before = (piece.positions[v] - piece.positions[0]).norm();
      EXPECT_NEAR((placed.positions[v] - placed.positions[0]).norm(), before, 1e-9);
      EXPECT_NEAR(placed.positions[v].y(), piece.positions[v].y(), 1e-9);
    }
  });
}

TEST(VirtualRecording, TheShippedRecordingIsWhatTheVirtualSensorShows) {
  Result<std::unique_ptr<OniFile>> source = openOni(test::recordingsFolder() / "wave_depth.oni");
  ASSERT_TRUE(source) << source.error().message;
  ASSERT_EQ((*source)->info().frameCount, 80);
  EXPECT_FALSE((*source)->info().cutOff);
  EXPECT_EQ((*source)->camera().width, 640);
  EXPECT_EQ((*source)->camera().height, 480);
  VirtualSensor sensor =
      makeVirtualSensor(parseVirtualScript("motion=wave start=0.7 pace=fast noise=mild").value()).value();
  DepthFrame recorded, shown;
  for (const int number : {0, 41, 79}) {
    (*source)->seek(number);
    ASSERT_EQ((*source)->next(recorded).value(), DepthRead::kFrame);
    EXPECT_NEAR(recorded.time, number / 30.0, 1e-6);
    sensor.render(static_cast<std::uint64_t>(number), shown);
    // Bit-identical on the platform where it was made; other math libraries may shift an edge by a pixel.
    int differing = 0;
    for (std::size_t i = 0; i < shown.depthMm.size(); ++i) differing += shown.depthMm[i] != recorded.depthMm[i] ? 1 : 0;
    EXPECT_LT(differing, 640 * 480 / 1000);
  }
}

TEST(VirtualScript, AnEmptyScriptIsOnePersonWhoWavesLive) {
  for (const char* text : {"", "   "}) {
    const VirtualScript script = parseVirtualScript(text).value();
    EXPECT_EQ(script.motions, std::vector<std::string>{"wave"});
    EXPECT_TRUE(script.settings.live);
    EXPECT_TRUE(script.settings.loop);
    EXPECT_EQ(script.settings.noise, DepthNoiseSettings{});
  }
}

TEST(VirtualScript, EverySettingIsTaken) {
  const VirtualScript script = parseVirtualScript(
                                   "motion=walk,dance.csv loop=no pace=fast seed=18446744073709551615 noise=mild "
                                   "start=1.5 height=1.1 girth=1.25 distance=2.5 unplug=2:4.5 absent=1:2")
                                   .value();
  EXPECT_EQ(script.motions, (std::vector<std::string>{"walk", "dance.csv"}));
  EXPECT_FALSE(script.settings.loop);
  EXPECT_FALSE(script.settings.live);
  EXPECT_EQ(script.settings.noise.seed, ~std::uint64_t{0});
  EXPECT_LT(script.settings.noise.axial, 1.0);
  EXPECT_EQ(script.start, 1.5);
  EXPECT_EQ(script.height, 1.1);
  EXPECT_EQ(script.girth, 1.25);
  EXPECT_EQ(script.settings.room.worldFromCamera.translation().z(), 2.5);
  EXPECT_EQ(script.settings.unplugged.at(0).to, 4.5);
  EXPECT_EQ(script.absent.at(0).from, 1.0);
}

TEST(VirtualScript, TheNoiseBringsItsCamera) {
  const VirtualScript kinect = parseVirtualScript("size=half").value();
  EXPECT_EQ(kinect.settings.camera.width, 320);
  EXPECT_EQ(kinect.settings.camera.height, 240);
  EXPECT_EQ(kinect.settings.camera.horizontalFov, DepthCamera{}.horizontalFov);
}

TEST(VirtualScript, WrongNamesAreAnsweredWithTheKnownOnes) {
  for (const auto& [text, known] :
       {std::pair{"noise=loud", "kinect, mild or none"}, std::pair{"size=320x240", "half or full"}}) {
    const Result<VirtualScript> script = parseVirtualScript(text);
    ASSERT_FALSE(script) << text;
    EXPECT_NE(script.error().message.find(known), std::string::npos) << script.error().message;
  }
}

TEST(VirtualScript, ErrorsAreReported) {
  for (const char* text : {"motion=",      "motion=flying", "motion=walk,wave,walk",
                           "motion=.csv",  "loop",          "loop=maybe",
                           "seed=-1",      "seed=1e3",      "noise=loud",
                           "height=0",     "height=nan",    "height=1.1x",
                           "unplug=2",     "unplug=4:2",    "unplug=2:4:5",
                           "absent=a:b",   "speed=2",       "seed=1 seed=2",
                           "clothes=coat", "noise=tof",     "=",
                           "distance=99"}) {
    const Result<VirtualScript> script = parseVirtualScript(text);
    ASSERT_FALSE(script) << text;
    EXPECT_NE(script.error().message.find("expected"), std::string::npos) << script.error().message;
  }
}

TEST(VirtualScript, TwoPeopleStandSideBySideAndFilesAreRead) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(writeJointCsv(folder.path() / "mine.csv", shippedFrames("wave")));
  const std::string text = "pace=fast motion=wave," + (folder.path() / "mine.csv").string();
  VirtualSensor sensor = makeVirtualSensor(parseVirtualScript(text).value()).value();
  DepthFrame frame;
  ASSERT_EQ(sensor.next(frame).value(), DepthRead::kFrame);
  ASSERT_EQ(sensor.truth().size(), 2U);
  for (const VirtualTruth& truth : sensor.truth()) EXPECT_GT(truth.pixelCount, 15000);
  const Vec3 apart =
      sensor.truth()[1].joints[BodyJoint::kTorso].position - sensor.truth()[0].joints[BodyJoint::kTorso].position;
  EXPECT_NEAR((apart - Vec3(1.3, 0.0, 0.0)).norm(), 0.0, 1e-6);
  EXPECT_FALSE(makeVirtualSensor(parseVirtualScript("motion=absent.csv").value()).ok());
}

}  // namespace
}  // namespace lorica
