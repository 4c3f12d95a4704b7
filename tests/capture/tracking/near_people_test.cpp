#include "tests/bench/generators/near_people.h"

#include "capture/sensor/oni_file.h"
#include "capture/tracking/tracker.h"
#include "tests/bench/generators/other_cameras.h"
#include "tests/support/allocations.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

namespace lorica {
namespace {

TEST(NearPeople, AreFollowedFromTheWaistUp) {
  for (const NearScene& scene : nearScenes()) {
    // The others are measured by bench/tracking --near.
    constexpr std::array<std::string_view, 5> kTried = {"turning_08", "waving_06", "waving_12", "leaning_12",
                                                        "face_06"};
    if (std::ranges::find(kTried, scene.name) == kTried.end()) continue;
    SCOPED_TRACE(scene.name);
    VirtualSensor sensor = nearSensor(scene, 3);
    Tracker tracker = Tracker::create(sensor.camera()).value();
    NearFigures figures;
    DepthFrame depth;
    std::vector<SkeletonFrame> seen;
    double height = 0.0;
    for (std::uint64_t f = 0; f < 60; ++f) {
      sensor.render(f, depth);
      seen.clear();
      const long before = test::allocationCount();
      const std::span<const TrackedPerson> people = tracker.track(depth);
      if (f > 0) {
        EXPECT_EQ(test::allocationCount(), before) << "frame " << f;
      }
      for (const TrackedPerson& person : people) {
        seen.push_back(moved(person.skeleton, tracker.floorFromCamera().inverse()));
        height = person.height;
      }
      figures.add(sensor.truth()[0], seen);
    }
    EXPECT_GE(figures.first, 0);
    EXPECT_LE(figures.first, 10);
    EXPECT_EQ(figures.followed, figures.frames - figures.first);
    EXPECT_EQ(figures.others, 0);
    EXPECT_EQ(figures.headingOff, 0);
    EXPECT_GT(figures.sure, 3 * figures.followed);
    EXPECT_EQ(figures.sureOff, 0);
    EXPECT_LT(figures.trunkMm, 30.0);
    EXPECT_NEAR(height, 1.75, 0.1);  // an adult's, since nothing shows another
    const bool hipsBelow = scene.distance < 1.0;
    EXPECT_TRUE(figures.legsKnown == 0 || !hipsBelow);
  }
}

TEST(NearPeople, ThingsWithAHeadAndShouldersAreNobody) {
  const auto box = [](double x, double bottom, double back, double top, double front) {
    return Aabb{Vec3(-x, bottom, back), Vec3(x, top, front)};
  };
  const std::vector<std::vector<Aabb>> things = {
      {box(0.25, 0.5, -0.08, 1.05, 0.0), box(0.04, 1.0, -0.06, 1.12, -0.02), box(0.13, 1.1, -0.08, 1.3, 0.0)},
      {box(0.25, 0.5, -0.2, 1.05, 0.0), box(0.06, 1.0, -0.12, 1.12, -0.02), box(0.1, 1.1, -0.2, 1.32, 0.0)},
      {box(0.22, 0.5, -0.2, 1.08, 0.0), box(0.07, 1.08, -0.14, 1.3, 0.0)},
  };
  for (std::size_t t = 0; t < things.size(); ++t) {
    for (const double distance : {0.8, 1.2}) {
      SCOPED_TRACE(testing::Message() << "thing " << t << " at " << distance << " m");
      VirtualSensorSettings settings;
      settings.noise = noiseNamed(t % 2 == 0 ? "realsense" : "kinect");
      settings.camera = DepthCamera{640, 360, 1.22, 0.75};
      settings.room.worldFromCamera = worldFromCameraAt({0.0, 1.15, distance}, 0.0);
      settings.room.boxes = things[t];
      settings.loop = true;
      VirtualSensor sensor = VirtualSensor::create({}, settings).value();
      Tracker tracker = Tracker::create(sensor.camera()).value();
      DepthFrame depth;
      std::size_t somebody = 0;
      for (std::uint64_t f = 0; f < 35; ++f) {
        sensor.render(f, depth);
        somebody += tracker.track(depth).size();
      }
      EXPECT_EQ(somebody, 0U);
    }
  }
}

/// A depth image with rows and columns added that the camera does not measure.
void widen(const DepthFrame& from, const DepthCamera& camera, int side, int below, DepthFrame& to) {
  to.time = from.time;
  const int width = camera.width + 2 * side;
  to.depthMm.assign(static_cast<std::size_t>(width) * (camera.height + below), 0);
  for (int y = 0; y < camera.height; ++y) {
    const auto row = from.depthMm.begin() + static_cast<std::ptrdiff_t>(y) * camera.width;
    std::copy(row, row + camera.width, to.depthMm.begin() + static_cast<std::ptrdiff_t>(y) * width + side);
  }
}

TEST(RealPeople, SomebodyNearIsFollowedWhileTheyTurnAround) {
  LORICA_REQUIRE_DATASET(oni, "depth_real/near_waist_up.oni");
  // As it is, and as cameras give it that align their depth with a picture.
  for (const auto& [side, below] : {std::pair{0, 0}, {44, 0}, {0, 72}}) {
    SCOPED_TRACE(testing::Message() << side << " " << below);
    const std::unique_ptr<OniFile> source = openOni(oni).value();
    DepthCamera camera = source->camera();
    camera.width += 2 * side;
    camera.height += below;
    camera.horizontalFov = 2.0 * std::atan(0.5 * camera.width / source->camera().focalX());
    camera.verticalFov = 2.0 * std::atan(0.5 * camera.height / source->camera().focalY());
    Tracker tracker = Tracker::create(camera).value();
    DepthFrame depth, shown;
    int first = -1;
    for (int frame = 0; source->next(depth).value() == DepthRead::kFrame; ++frame) {
      widen(depth, source->camera(), side, below, shown);
      const auto people = tracker.track(shown);
      EXPECT_LE(people.size(), 1U);
      if (first < 0 && !people.empty()) first = frame;
      if (frame < 10) continue;
      ASSERT_EQ(people.size(), 1U) << "frame " << frame;
      const SkeletonFrame& joints = people[0].skeleton;
      const Vec3 across = joints[BodyJoint::kLeftShoulder].position - joints[BodyJoint::kRightShoulder].position;
      // From the side for some frames in between.
      EXPECT_TRUE(frame >= 19 || across.x() > 0.05) << "frame " << frame;
      EXPECT_TRUE(frame < 32 || across.x() < -0.05) << "frame " << frame;
      EXPECT_NEAR(people[0].height, 1.75, 0.15);
      for (std::size_t j = static_cast<std::size_t>(BodyJoint::kLeftHip); j < kBodyJointCount; ++j) {
        EXPECT_EQ(joints.joints[j].confidence, 0.0);
      }
    }
    EXPECT_GE(first, 0);
    EXPECT_LE(first, 10);
  }
}

}  // namespace
}  // namespace lorica
