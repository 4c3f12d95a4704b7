#include "capture/tracking/people/floor.h"

#include "capture/synthetic/synthetic_motion.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica {
namespace {

struct Seen {
  bool found = false;
  double heightError = 0.0;  // [m]
  double tiltError = 0.0;    // [rad]
};

/// Result of the finder on some frames of a room, compared with the camera's true pose.
Seen look(const VirtualRoom& room, bool noisy, int frames = 12, std::vector<VirtualPerson> people = {}) {
  VirtualSensorSettings settings;
  settings.room = room;
  if (!noisy) settings.noise = DepthNoiseSettings::clean();
  settings.loop = true;
  VirtualSensor sensor = VirtualSensor::create(std::move(people), settings).value();
  DepthGrid grid(sensor.camera());
  FloorFinder finder(grid);
  DepthFrame frame;
  for (int f = 0; f < frames; ++f) {
    sensor.render(static_cast<std::uint64_t>(f), frame);
    grid.fill(frame.depthMm);
    finder.update(grid);
  }
  const Vec3 up = room.worldFromCamera.linear().transpose() * Vec3::UnitY();
  Seen seen;
  seen.found = finder.found();
  seen.heightError = std::abs(finder.height() - room.worldFromCamera.translation().y());
  seen.tiltError = std::acos(std::min(1.0, finder.up().dot(up)));
  return seen;
}

std::vector<VirtualPerson> standing(double z) {
  std::vector<VirtualPerson> people;
  VirtualPerson person{VirtualPerformer::create(makeMannequin(), synthesizeMotion(SyntheticMotion::kWave)).value()};
  person.worldFromMotion.translation() = Vec3(0.0, 0.0, z);
  people.push_back(std::move(person));
  return people;
}

TEST(FloorFinder, NothingMeasuredIsNoFloor) {
  DepthGrid grid{DepthCamera{}};
  FloorFinder finder(grid);
  finder.update(grid);
  EXPECT_FALSE(finder.found());
  EXPECT_EQ(finder.floorFromCamera().translation(), Vec3(0.0, 1.2, 0.0));
  EXPECT_EQ(finder.floorFromCamera().linear(), Mat3::Identity());
}

TEST(FloorFinder, PlaneIsFoundWhereverTheCameraStands) {
  struct Position {
    double height, tilt, heading;
  };
  for (const Position& p : {Position{0.6, 0.0, 0.0}, {1.1, 0.05, 0.0}, {1.5, 0.25, 0.3}, {2.4, 0.6, -0.2}}) {
    SCOPED_TRACE(p.height);
    VirtualRoom room;
    room.worldFromCamera = worldFromCameraAt({0.2, p.height, 2.5}, p.tilt, p.heading);
    const Seen clean = look(room, false), noisy = look(room, true);
    EXPECT_TRUE(clean.found);
    EXPECT_LT(clean.heightError, 0.02);
    EXPECT_LT(clean.tiltError, 0.006);
    EXPECT_TRUE(noisy.found);
    EXPECT_LT(noisy.heightError, 0.02);
    EXPECT_LT(noisy.tiltError, 0.01);
  }
}

TEST(FloorFinder, RolledCameraIsToldFromALevelOne) {
  VirtualRoom room;
  room.worldFromCamera.linear() =
      room.worldFromCamera.linear() * Eigen::AngleAxisd(0.15, Vec3::UnitZ()).toRotationMatrix();
  const Seen seen = look(room, true);
  EXPECT_TRUE(seen.found);
  EXPECT_LT(seen.tiltError, 0.01);
}

TEST(FloorFinder, PersonOnItChangesNothing) {
  const Seen seen = look(VirtualRoom{}, true, 12, standing(0.3));
  EXPECT_TRUE(seen.found);
  EXPECT_LT(seen.heightError, 0.015);
  EXPECT_LT(seen.tiltError, 0.01);
}

TEST(FloorFinder, WallAloneIsNoFloor) {
  VirtualRoom room;
  room.floor = false;
  EXPECT_FALSE(look(room, false).found);
  EXPECT_FALSE(look(room, true, 12, standing(-0.5)).found);
}

TEST(FloorFinder, TableIsNotTakenForTheFloor) {
  // A table fills the lower part of the image; beyond its edge the floor is visible, or the wall below the table's
  // height.
  VirtualRoom room;
  room.worldFromCamera = worldFromCameraAt({0.0, 1.3, 2.7}, 0.2);
  room.boxes.push_back({Vec3(-1.5, 0.0, 0.2), Vec3(1.5, 0.72, 2.3)});
  for (const bool floor : {true, false}) {
    room.floor = floor;
    const Seen seen = look(room, true);
    if (seen.found) {
      EXPECT_TRUE(floor);
      EXPECT_LT(seen.heightError, 0.03);
    }
  }
}

TEST(FloorFinder, FrameLiesBelowTheCameraAndLooksAlongMinusZ) {
  VirtualSensorSettings settings;
  settings.room.worldFromCamera = worldFromCameraAt({0.4, 1.4, 2.2}, 0.3, 0.5);
  settings.noise = DepthNoiseSettings::clean();
  VirtualSensor sensor = VirtualSensor::create({}, settings).value();
  DepthGrid grid(sensor.camera());
  FloorFinder finder(grid);
  DepthFrame frame;
  sensor.render(0, frame);
  grid.fill(frame.depthMm);
  finder.update(grid);
  ASSERT_TRUE(finder.found());
  EXPECT_LT((finder.floorFromCamera().matrix() - sensor.floorFromCamera().matrix()).norm(), 0.005);
}

TEST(FloorFinder, CameraThatIsMovedIsFollowed) {
  VirtualSensorSettings settings;
  settings.noise.seed = 5;
  VirtualSensor low = VirtualSensor::create({}, settings).value();
  settings.room.worldFromCamera = worldFromCameraAt({0.0, 1.7, 2.7}, 0.3);
  VirtualSensor high = VirtualSensor::create({}, settings).value();
  DepthGrid grid(low.camera());
  FloorFinder finder(grid);
  DepthFrame frame;
  for (std::uint64_t f = 0; f < 110; ++f) {
    (f < 20 ? low : high).render(f % 4, frame);
    grid.fill(frame.depthMm);
    finder.update(grid);
  }
  EXPECT_NEAR(finder.height(), 1.7, 0.03);
}

}  // namespace
}  // namespace lorica
