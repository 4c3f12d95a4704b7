#include "capture/tracking/people/head_finder.h"

#include "capture/synthetic/synthetic_motion.h"
#include "capture/tracking/people/walls.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace lorica {
namespace {

VirtualSensor sensorBefore(const std::vector<double>& places, const VirtualRoom& room) {
  std::vector<VirtualPerson> people;
  for (const double x : places) {
    people.push_back({VirtualPerformer::create(makeMannequin(), synthesizeMotion(SyntheticMotion::kWave)).value()});
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
  room.boxes = chairAt({0.3, 0.0, 0.0});
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
  walls.update(seen.grid, up.cast<float>());
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
  walls.update(seen.grid, Vec3f::UnitY());
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

}  // namespace
}  // namespace lorica
