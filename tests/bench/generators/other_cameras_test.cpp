#include "tests/bench/generators/other_cameras.h"
#include "capture/files/joint_csv.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

TEST(OtherCameras, TheNoiseBringsItsCamera) {
  const DepthCamera stereo = noiseNamed("realsense").sensor;
  EXPECT_EQ(stereo.width, 640);
  EXPECT_NEAR(stereo.focalX(), 617.25, 0.1);
  EXPECT_NEAR(stereo.focalY(), 617.6, 0.5);
  VirtualSensorSettings settings;
  settings.noise = noiseNamed("tof");
  settings.camera = settings.noise.sensor;
  EXPECT_EQ(settings.camera.width, 512);
  EXPECT_EQ(settings.camera.height, 424);
  EXPECT_NEAR(settings.camera.focalX(), 365.5, 0.5);
  EXPECT_NEAR(settings.camera.focalY(), 365.5, 0.5);
  std::vector<VirtualPerson> people;
  people.push_back({VirtualPerformer::create(makeMannequin(), shippedFrames("wave")).value()});
  VirtualSensor sensor = VirtualSensor::create(std::move(people), settings).value();
  DepthFrame frame;
  sensor.render(0, frame);
  EXPECT_EQ(frame.depthMm.size(), 512U * 424U);
}

}  // namespace
}  // namespace lorica
