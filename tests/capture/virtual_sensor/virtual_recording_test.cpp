#include "capture/sensor/oni_source.h"
#include "capture/virtual_sensor/virtual_script.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace lorica {
namespace {

TEST(VirtualRecording, TheShippedRecordingIsWhatTheVirtualSensorShows) {
  Result<std::unique_ptr<OniSource>> source = openOni(test::recordingsFolder() / "wave_depth.oni");
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

}  // namespace
}  // namespace lorica
