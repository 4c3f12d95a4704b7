#include "capture/virtual_sensor/virtual_script.h"

#include "capture/files/joint_csv.h"
#include "capture/synthetic/synthetic_motion.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace lorica {
namespace {

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
  const VirtualScript stereo = parseVirtualScript("seed=7 noise=realsense size=full").value();
  EXPECT_EQ(stereo.settings.camera.width, 640);
  EXPECT_NEAR(stereo.settings.camera.focalX(), 617.25, 0.1);
  EXPECT_NEAR(stereo.settings.camera.focalY(), 617.6, 0.5);
  EXPECT_EQ(stereo.settings.noise.seed, 7U);
  const VirtualScript tof = parseVirtualScript("noise=tof").value();
  EXPECT_EQ(tof.settings.camera.width, 512);
  EXPECT_EQ(tof.settings.camera.height, 424);
  EXPECT_NEAR(tof.settings.camera.focalX(), 365.5, 0.5);
  EXPECT_NEAR(tof.settings.camera.focalY(), 365.5, 0.5);
  VirtualSensor sensor = makeVirtualSensor(tof).value();
  DepthFrame frame;
  sensor.render(0, frame);
  EXPECT_EQ(frame.depthMm.size(), 512U * 424U);
}

TEST(VirtualScript, PeopleWearClothes) {
  const VirtualScript script = parseVirtualScript("clothes=skirt,hair noise=none pace=fast").value();
  EXPECT_EQ(script.clothes, (std::vector<Clothes>{Clothes::kSkirt, Clothes::kHair}));
  VirtualSensor dressed = makeVirtualSensor(script).value();
  VirtualSensor bare = makeVirtualSensor(parseVirtualScript("noise=none pace=fast").value()).value();
  DepthFrame frame;
  dressed.render(0, frame);
  bare.render(0, frame);
  EXPECT_GT(dressed.truth()[0].pixelCount, 1.15 * bare.truth()[0].pixelCount);
}

TEST(VirtualScript, WrongNamesAreAnsweredWithTheKnownOnes) {
  for (const auto& [text, known] :
       {std::pair{"noise=loud", "kinect, realsense, tof, mild or none"},
        std::pair{"clothes=hat", "trousers, skirt, coat or hair"},
        std::pair{"clothes=coat,coat", "trousers, skirt, coat or hair"},
        std::pair{"clothes=", "trousers, skirt, coat or hair"}, std::pair{"size=320x240", "half or full"}}) {
    const Result<VirtualScript> script = parseVirtualScript(text);
    ASSERT_FALSE(script) << text;
    EXPECT_NE(script.error().message.find(known), std::string::npos) << script.error().message;
  }
}

TEST(VirtualScript, ErrorsAreReported) {
  for (const char* text : {"motion=",     "motion=flying", "motion=walk,wave,walk",
                           "motion=.csv", "loop",          "loop=maybe",
                           "seed=-1",     "seed=1e3",      "noise=loud",
                           "height=0",    "height=nan",    "height=1.1x",
                           "unplug=2",    "unplug=4:2",    "unplug=2:4:5",
                           "absent=a:b",  "speed=2",       "seed=1 seed=2",
                           "=",           "distance=99"}) {
    const Result<VirtualScript> script = parseVirtualScript(text);
    ASSERT_FALSE(script) << text;
    EXPECT_NE(script.error().message.find("expected"), std::string::npos) << script.error().message;
  }
}

TEST(VirtualScript, TwoPeopleStandSideBySideAndFilesAreRead) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(writeJointCsv(folder.path() / "mine.csv", synthesizeMotion(SyntheticMotion::kWave)));
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
