#include "capture/tracking/people/head_finder.h"
#include "capture/files/joint_csv.h"

#include "capture/tracking/people/room_planes.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/chair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lorica {
namespace {

VirtualSensor sensorBefore(const std::vector<double>& places, const VirtualRoom& room) {
  std::vector<VirtualPerson> people;
  for (const double x : places) {
    people.push_back({VirtualPerformer::create(makeMannequin(), shippedFrames("wave")).value()});
    people.back().worldFromMotion.translation().x() = x;
  }
  VirtualSensorSettings settings;
  settings.room = room;
  settings.noise.seed = 4;
  return VirtualSensor::create(std::move(people), settings).value();
}

/// A grid and floor positions of one frame; the floor frame is the true one.
struct Seen {
  explicit Seen(VirtualSensor& sensor, std::uint64_t number = 5) : grid(sensor.camera()), positions(grid) {
    sensor.render(number, frame);
    grid.fill(frame.depthMm);
    positions.set(grid, sensor.floorFromCamera());
  }
  DepthFrame frame;
  DepthGrid grid;
  FloorPositions positions;
};

TEST(HeadFinder, FindsEveryHeadWhereItIs) {
  for (const std::vector<double>& places : {std::vector<double>{0.0}, {-0.6, 0.6}}) {
    VirtualSensor sensor = sensorBefore(places, {});
    const Seen seen(sensor);
    HeadFinder finder(seen.grid);
    const auto heads = finder.find(seen.grid, seen.positions, true);
    ASSERT_EQ(heads.size(), places.size());
    for (const VirtualTruth& truth : sensor.truth()) {
      const SkeletonFrame joints = moved(truth.joints, sensor.floorFromCamera());
      const Vec3 head = joints[BodyJoint::kHead].position;
      const bool found = std::ranges::any_of(
          heads, [&](const FoundHead& one) { return (one.position.cast<double>() - head).norm() < 0.2; });
      EXPECT_TRUE(found) << head.transpose() << " found " << heads[0].position.transpose();
    }
  }
}

TEST(HeadFinder, WhatIsAsLowAsAKneeIsNoHead) {
  VirtualSensor sensor = sensorBefore({0.0}, {});
  Seen seen(sensor);
  // As if the floor were 1.2 m higher.
  Isometry3 floorFromCamera = sensor.floorFromCamera();
  floorFromCamera.translation().y() -= 1.2;
  seen.positions.set(seen.grid, floorFromCamera);
  HeadFinder finder(seen.grid);
  EXPECT_TRUE(finder.find(seen.grid, seen.positions, true).empty());
  EXPECT_EQ(finder.find(seen.grid, seen.positions, false).size(), 1U);
}

TEST(HeadFinder, FindsNoneInAnEmptyRoomWithFurniture) {
  VirtualRoom room;
  room.boxes = test::chairAt({0.3, 0.0, 0.0});
  room.boxes.push_back({Vec3(-1.6, 0.0, -1.2), Vec3(-0.8, 0.75, -0.4)});
  VirtualSensor sensor = sensorBefore({}, room);
  const Seen seen(sensor);
  HeadFinder finder(seen.grid);
  EXPECT_TRUE(finder.find(seen.grid, seen.positions, true).empty());
}

/// Share of the cells of the room's back wall, and of a person, that are marked as wall.
std::pair<double, double> marked(const VirtualRoom& room, const std::vector<double>& places) {
  VirtualSensor sensor = sensorBefore(places, room);
  const Seen seen(sensor);
  WallFinder walls(seen.grid);
  const Vec3 up = sensor.floorFromCamera().linear().transpose() * Vec3::UnitY();
  walls.update(seen.grid, up.cast<float>(), false);
  std::vector<CellKind> kinds(seen.grid.cellCount(), CellKind::kNone);
  walls.mark(seen.grid, kinds);
  int wall = 0, wallMarked = 0, person = 0, personMarked = 0;
  for (int r = 0; r < seen.grid.height; ++r) {
    for (int c = 0; c < seen.grid.width; ++c) {
      const std::size_t i = seen.grid.index(c, r);
      if (seen.grid.depthMm[i] == 0) continue;
      const auto pixel =
          static_cast<std::size_t>(r * seen.grid.step) * static_cast<std::size_t>(sensor.camera().width) +
          static_cast<std::size_t>(c * seen.grid.step);
      const bool isWall = kinds[i] == CellKind::kWall;
      if (sensor.labels()[pixel] != 0) {
        ++person;
        personMarked += static_cast<int>(isWall);
      } else if (seen.positions(seen.grid, c, r).y() > 0.3F) {
        ++wall;
        wallMarked += static_cast<int>(isWall);
      }
    }
  }
  return {static_cast<double>(wallMarked) / std::max(1, wall), static_cast<double>(personMarked) / std::max(1, person)};
}

TEST(WallFinder, MarksTheWallAndNotThePerson) {
  for (const double wall : {-1.6, -0.2}) {
    VirtualRoom room;
    room.wall = wall;
    const auto [ofWall, ofPerson] = marked(room, {0.0});
    EXPECT_GT(ofWall, 0.9) << wall;
    EXPECT_LT(ofPerson, 0.06) << wall;
  }
}

TEST(WallFinder, AShelfWithTheRoomBehindItIsNoWall) {
  VirtualRoom room;
  room.boxes.push_back({Vec3(-0.5, 0.0, -0.6), Vec3(0.5, 1.2, -0.3)});
  VirtualSensor sensor = sensorBefore({}, room);
  const Seen seen(sensor);
  WallFinder walls(seen.grid);
  walls.update(seen.grid, Vec3f::UnitY(), false);
  std::vector<CellKind> kinds(seen.grid.cellCount(), CellKind::kNone);
  walls.mark(seen.grid, kinds);
  int onShelf = 0;
  for (int r = 0; r < seen.grid.height; ++r) {
    for (int c = 0; c < seen.grid.width; ++c) {
      const Vec3f position = seen.positions(seen.grid, c, r);
      const bool shelf = seen.grid.depthMm[seen.grid.index(c, r)] != 0 && position.y() > 0.3F && position.y() < 1.1F &&
                         position.z() > -3.45F && position.z() < -3.25F;
      onShelf += static_cast<int>(shelf && kinds[seen.grid.index(c, r)] == CellKind::kWall);
    }
  }
  EXPECT_LT(onShelf, 50);
}

struct FoundFloor {
  bool found = false;
  double heightError = 0.0;  // [m]
  double tiltError = 0.0;    // [rad]
};

/// Result of the finder on some frames of a room, compared with the camera's true pose.
FoundFloor look(const VirtualRoom& room, bool noisy, int frames = 12, std::vector<VirtualPerson> people = {}) {
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
    finder.update(grid, false);
  }
  const Vec3 up = room.worldFromCamera.linear().transpose() * Vec3::UnitY();
  FoundFloor seen;
  seen.found = finder.found();
  seen.heightError = std::abs(finder.height() - room.worldFromCamera.translation().y());
  seen.tiltError = std::acos(std::min(1.0, finder.up().dot(up)));
  return seen;
}

std::vector<VirtualPerson> standing(double z) {
  std::vector<VirtualPerson> people;
  VirtualPerson person{VirtualPerformer::create(makeMannequin(), shippedFrames("wave")).value()};
  person.worldFromMotion.translation() = Vec3(0.0, 0.0, z);
  people.push_back(std::move(person));
  return people;
}

TEST(FloorFinder, NothingMeasuredIsNoFloor) {
  DepthGrid grid{DepthCamera{}};
  FloorFinder finder(grid);
  finder.update(grid, false);
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
    const FoundFloor clean = look(room, false), noisy = look(room, true);
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
  const FoundFloor seen = look(room, true);
  EXPECT_TRUE(seen.found);
  EXPECT_LT(seen.tiltError, 0.01);
}

TEST(FloorFinder, PersonOnItChangesNothing) {
  const FoundFloor seen = look(VirtualRoom{}, true, 12, standing(0.3));
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
    const FoundFloor seen = look(room, true);
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
  finder.update(grid, false);
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
    finder.update(grid, false);
  }
  EXPECT_NEAR(finder.height(), 1.7, 0.03);
}

}  // namespace
}  // namespace lorica
