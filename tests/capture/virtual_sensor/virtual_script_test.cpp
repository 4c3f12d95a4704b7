#include "capture/virtual_sensor/virtual_script.h"

#include "capture/files/joint_csv.h"
#include "capture/synthetic/synthetic_motion.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <string>

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
