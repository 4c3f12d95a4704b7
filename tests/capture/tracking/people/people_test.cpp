#include "capture/tracking/people/people.h"

#include "capture/files/joint_csv.h"
#include "capture/sensor/oni_file.h"
#include "capture/virtual_sensor/virtual_performer.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/allocations.h"
#include "tests/support/chair.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace lorica {
namespace {

Isometry3 at(double x, double z, double turn = 0.0) {
  Isometry3 result = Isometry3::Identity();
  result.linear() = Eigen::AngleAxisd(turn, Vec3::UnitY()).toRotationMatrix();
  result.translation() = Vec3(x, 0.0, z);
  return result;
}

VirtualPerson performing(std::string_view motion, const Isometry3& pose = Isometry3::Identity(), double start = 0.0) {
  VirtualPerson person{VirtualPerformer::create(makeMannequin(), shippedFrames(motion)).value()};
  person.worldFromMotion = pose;
  person.start = start;
  return person;
}

template <typename... Person>
std::vector<VirtualPerson> everyone(Person... person) {
  std::vector<VirtualPerson> all;
  all.reserve(sizeof...(person));
  (all.push_back(std::move(person)), ...);
  return all;
}

/// How well a person's label matches the truth, without pixels that have no depth. Noise moves edges by about a pixel,
/// so pixels next to a true edge are ignored if there is noise.
struct Overlap {
  double score = 0.0;  // intersection over union with the best label
  int user = 0;
};

Overlap overlapOf(const PeopleFinder& finder, const VirtualSensor& sensor, std::uint8_t truth, bool edges) {
  const auto labels = finder.labels(), clean = sensor.labels();
  const int w = sensor.camera().width, h = sensor.camera().height;
  std::array<int, 256> both{}, found{};
  int there = 0;
  for (int y = 1; y + 1 < h; ++y) {
    for (int x = 1; x + 1 < w; ++x) {
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x);
      if (labels[i] == 255) continue;
      const auto row = static_cast<std::size_t>(w);
      if (!edges && (clean[i - 1] != clean[i] || clean[i + 1] != clean[i] || clean[i - row] != clean[i] ||
                     clean[i + row] != clean[i])) {
        continue;
      }
      ++found[labels[i]];
      there += static_cast<int>(clean[i] == truth);
      both[labels[i]] += static_cast<int>(clean[i] == truth);
    }
  }
  Overlap best;
  for (std::size_t label = 1; label <= finder.people().size(); ++label) {
    const double score = both[label] / std::max(1.0, static_cast<double>(there + found[label] - both[label]));
    if (score > best.score) best = {score, finder.people()[label - 1].user};
  }
  return best;
}

struct Watched {
  std::vector<double> mean, min;     ///< of overlaps, one per person
  std::vector<std::set<int>> users;  ///< assigned to each person
  std::size_t maxPeople = 0;
};

/// @param each  called after each frame
template <typename Each>
Watched watch(std::vector<VirtualPerson> people, VirtualSensorSettings settings, bool noisy, std::uint64_t frames,
              std::uint64_t stride, const Each& each) {
  if (!noisy) settings.noise = DepthNoiseSettings::clean();
  settings.loop = true;
  VirtualSensor sensor = VirtualSensor::create(std::move(people), settings).value();
  PeopleFinder finder(sensor.camera(), 2);
  DepthFrame frame;
  Watched result;
  int counted = 0;
  for (std::uint64_t f = 0; f < frames; ++f) {
    sensor.render(f * stride, frame);
    finder.find(frame);
    result.maxPeople = std::max(result.maxPeople, finder.people().size());
    const std::size_t count = sensor.truth().size();
    result.mean.resize(count);
    result.min.resize(count, 1.0);
    result.users.resize(count);
    ++counted;
    for (std::size_t p = 0; p < count; ++p) {
      const Overlap overlap = overlapOf(finder, sensor, static_cast<std::uint8_t>(p + 1), !noisy);
      result.mean[p] += overlap.score;
      result.min[p] = std::min(result.min[p], overlap.score);
      if (overlap.score > 0.5) result.users[p].insert(overlap.user);
    }
    each(f, finder, sensor);
  }
  for (double& mean : result.mean) mean /= counted;
  return result;
}
Watched watch(std::vector<VirtualPerson> people, const VirtualSensorSettings& settings, bool noisy,
              std::uint64_t frames, std::uint64_t stride = 1) {
  return watch(std::move(people), settings, noisy, frames, stride, [](auto&&...) {});
}

TEST(PeopleFinder, EmptyImageHasNobody) {
  const DepthCamera camera;
  PeopleFinder finder(camera, 2);
  DepthFrame frame;
  frame.depthMm.resize(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  finder.find(frame);
  EXPECT_TRUE(finder.people().empty());
  EXPECT_FALSE(finder.floorFound());
  EXPECT_TRUE(std::ranges::all_of(finder.labels(), [](std::uint8_t label) { return label == 255; }));
}

TEST(PeopleFinder, RoomWithFurnitureHasNobody) {
  VirtualSensorSettings settings;
  settings.room.boxes = test::chairAt({0.3, 0.0, 0.0});
  settings.room.boxes.push_back({Vec3(-1.6, 0.0, -1.2), Vec3(-0.8, 0.75, -0.4)});
  const Watched seen = watch({}, settings, true, 20);
  EXPECT_EQ(seen.maxPeople, 0U);
}

TEST(PeopleFinder, StandsInTheFirstFrameAndIsCoveredCleanAndNoisy) {
  for (const bool noisy : {false, true}) {
    for (const std::string_view motion : {"jumping_jacks", "punch_and_kick"}) {
      SCOPED_TRACE(motion);
      const Watched seen = watch(everyone(performing(motion)), {}, noisy, 20, 7);
      EXPECT_GE(seen.mean[0], 0.97);
      EXPECT_GE(seen.min[0], 0.95);
      EXPECT_EQ(seen.users[0], std::set<int>{1});
      EXPECT_EQ(seen.maxPeople, 1U);
    }
  }
}

TEST(PeopleFinder, SeveralCamerasSeeTheSamePerson) {
  struct Position {
    Vec3 pose;
    double tilt, heading;
  };
  for (const Position& p :
       {Position{{0.5, 2.3, 2.3}, 0.5, 0.2}, {{0.0, 0.6, 2.8}, -0.1, 0.0}, {{0.0, 1.1, 3.9}, 0.05, 0.0}}) {
    SCOPED_TRACE(p.pose.transpose());
    VirtualSensorSettings settings;
    settings.room.worldFromCamera = worldFromCameraAt(p.pose, p.tilt, p.heading);
    const Watched seen = watch(everyone(performing("squat_and_reach")), settings, true, 15, 9);
    EXPECT_GE(seen.mean[0], 0.95);
    EXPECT_EQ(seen.users[0], std::set<int>{1});
  }
}

TEST(PeopleFinder, ImagesOfOddSizeAreLabelledInPlace) {
  VirtualSensorSettings settings;
  settings.camera.width = 639;
  settings.camera.height = 479;
  const Watched seen = watch(everyone(performing("wave")), settings, false, 2, 1);
  EXPECT_GE(seen.mean[0], 0.95);
}

TEST(PeopleFinder, TwoPeopleAreKeptApart) {
  const Watched seen =
      watch(everyone(performing("wave", at(-0.6, 0.0)), performing("jumping_jacks", at(0.7, -0.4))), {}, true, 40, 2);
  for (const std::size_t p : {0U, 1U}) {
    EXPECT_GE(seen.mean[p], 0.95);
    EXPECT_EQ(seen.users[p].size(), 1U);
  }
  EXPECT_NE(seen.users[0], seen.users[1]);
}

TEST(PeopleFinder, PeopleWhoTouchAreSharedOut) {
  // The arms of jumping jacks reach into the neighbour.
  const Watched seen =
      watch(everyone(performing("squat_and_reach", at(-0.4, 0.0)), performing("jumping_jacks", at(0.55, 0.0))), {},
            false, 100);
  for (const std::size_t p : {0U, 1U}) {
    EXPECT_GE(seen.mean[p], 0.95);
    EXPECT_GE(seen.min[p], 0.8);
    EXPECT_EQ(seen.users[p].size(), 1U);
  }
}

TEST(PeopleFinder, NumberIsKeptBehindAScreenAndReusedAfterTwoSeconds) {
  for (const double hidden : {1.0, 2.5}) {
    VirtualSensorSettings settings;
    settings.screens.push_back({{Vec3(-1.6, 0.0, 1.3), Vec3(1.6, 2.2, 1.35)}, {0.3, 0.3 + hidden}});
    int usersAfter = 0, peopleBehind = 0;
    const auto frames = static_cast<std::uint64_t>(30.0 * (0.3 + hidden) + 4.0);
    watch(everyone(performing("wave")), settings, true, frames, 1,
          [&](std::uint64_t f, const PeopleFinder& finder, const VirtualSensor&) {
            if (f == 25) peopleBehind = static_cast<int>(finder.people().size());
            if (f + 1 == frames) usersAfter = static_cast<int>(finder.people().size());
          });
    EXPECT_EQ(peopleBehind, 0);
    EXPECT_EQ(usersAfter, 1);
  }
}

TEST(PeopleFinder, WhoPassesBehindAnotherKeepsTheNumber) {
  const Watched seen =
      watch(everyone(performing("walk", at(-0.9, -1.0, 1.5707963)), performing("wave", at(0.3, 0.0))), {}, true, 55, 2);
  EXPECT_EQ(seen.users[1], std::set<int>{seen.users[1].empty() ? 0 : *seen.users[1].begin()});
  EXPECT_GE(seen.mean[1], 0.85);  // pieces of the person behind are assigned to the other for some frames
}

TEST(PeopleFinder, WhoEntersIsFoundAndWhatHeWalkedPastIsNot) {
  std::vector<VirtualPerson> people = everyone(performing("wave"));
  people[0].absent.push_back({0.0, 1.5});
  people[0].leaveSpeed = 1.5;
  VirtualSensorSettings settings;
  settings.room.boxes = test::chairAt({0.9, 0.0, -0.6});
  double last = 0.0;
  const Watched seen = watch(std::move(people), settings, true, 60, 1,
                             [&](std::uint64_t, const PeopleFinder& finder, const VirtualSensor& sensor) {
                               last = overlapOf(finder, sensor, 1, false).score;
                             });
  EXPECT_EQ(seen.maxPeople, 1U);
  EXPECT_GE(last, 0.96);
}

TEST(PeopleFinder, WhoSitsDownIsToldFromTheChair) {
  // Squats over a chair that was there before.
  VirtualSensorSettings settings;
  settings.room.boxes = test::chairAt({0.0, 0.0, -0.5});
  const Watched seen = watch(everyone(performing("squat_and_reach")), settings, true, 30, 4);
  EXPECT_GE(seen.mean[0], 0.95);
  EXPECT_GE(seen.min[0], 0.9);
}

TEST(PeopleFinder, WhoSteppedBackOnceIsNoFurniture) {
  // A person stepping straight back uncovers nothing new. After that they stand still for longer than furniture may.
  std::vector<SkeletonFrame> back;
  back.reserve(31);
  for (int i = 0; i <= 30; ++i) {
    SkeletonFrame& frame = back.emplace_back(shippedFrames("jumping_jacks").front());
    frame.time = i / 30.0;
    for (TrackedJoint& joint : frame.joints) joint.position.z() -= 0.6 * frame.time;
  }
  VirtualSensor sensor =
      VirtualSensor::create(everyone(VirtualPerson{VirtualPerformer::create(makeMannequin(), back).value()})).value();
  PeopleFinder finder(sensor.camera(), 2);
  DepthFrame frame;
  for (std::uint64_t f = 0; f < 20; ++f) {
    sensor.render(f < 10 ? 3 * f : 30 + 72 * (f - 9), frame);  // past its end the last pose stays
    finder.find(frame);
    EXPECT_EQ(finder.people().size(), 1U) << frame.time;
  }
  EXPECT_GT(frame.time, 20.0);
}

TEST(PeopleFinder, ShelfThatTheImageCutsOffIsNobody) {
  VirtualSensorSettings settings;
  settings.room.boxes = {{Vec3(-2.1, 0.0, -0.7), Vec3(-1.5, 2.4, -0.4)}};
  std::size_t max = 0;
  const Watched seen = watch(everyone(performing("wave", at(0.3, 0.0))), settings, true, 12, 1,
                             [&](std::uint64_t, const PeopleFinder& finder, const VirtualSensor&) {
                               max = std::max(max, finder.people().size());
                             });
  EXPECT_EQ(max, 1U);
  EXPECT_GE(seen.mean[0], 0.95);
}

TEST(PeopleFinder, WhoIsCutOffByTheImageIsFound) {
  VirtualSensorSettings settings;
  settings.room.worldFromCamera = worldFromCameraAt({0.35, 1.3, 1.0}, 0.0);
  const Watched seen = watch(everyone(performing("wave")), settings, true, 10, 3);
  EXPECT_GE(seen.mean[0], 0.97);
}

TEST(PeopleFinder, SegmentsSayWhereInTheFloorFrame) {
  watch(everyone(performing("jumping_jacks", at(0.3, 0.2))), {}, false, 2, 1,
        [](std::uint64_t, const PeopleFinder& finder, const VirtualSensor& sensor) {
          ASSERT_EQ(finder.people().size(), 1U);
          const PersonSegment& one = finder.people()[0];
          EXPECT_EQ(one.pixelCount, std::ranges::count(finder.labels(), 1));
          EXPECT_TRUE(finder.floorFound());
          // The torso, from the truth.
          const SkeletonFrame joints = moved(sensor.truth()[0].joints, sensor.floorFromCamera());
          EXPECT_NEAR(one.middle.x(), joints[BodyJoint::kTorso].position.x(), 0.06);
          EXPECT_NEAR(one.middle.z(), joints[BodyJoint::kTorso].position.z(), 0.15);
        });
}

TEST(PeopleFinder, SameFramesGiveTheSameLabelsAndTakeNoMemory) {
  VirtualSensorSettings settings;
  settings.loop = true;
  VirtualSensor sensor =
      VirtualSensor::create(everyone(performing("wave", at(-0.5, 0.0)), performing("punch_and_kick", at(0.6, 0.0))),
                            settings)
          .value();
  PeopleFinder one(sensor.camera(), 2), other(sensor.camera(), 2);
  DepthFrame frame;
  for (std::uint64_t f = 0; f < 16; ++f) {
    sensor.render(f * 3, frame);
    one.find(frame);
    const long before = test::allocationCount();
    other.find(frame);
    if (f >= 8) {
      EXPECT_EQ(test::allocationCount(), before) << f;
    }
    ASSERT_TRUE(std::ranges::equal(one.labels(), other.labels())) << f;
  }
}

TEST(PeopleFinder, RandomDepthIsSurvived) {
  // There is no expected result, except that it returns.
  const DepthCamera camera;
  PeopleFinder finder(camera, 2);
  DepthFrame frame;
  frame.depthMm.resize(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  std::uint32_t state = 12345;
  for (int f = 0; f < 6; ++f) {
    for (std::uint16_t& depth : frame.depthMm) {
      state = state * 1664525U + 1013904223U;
      depth = static_cast<std::uint16_t>(f < 3 ? state >> 16U : (state >> 28U) + 65'520U);
    }
    frame.time = f / 30.0;
    finder.find(frame);
  }
  EXPECT_LE(finder.people().size(), 2U);
}

TEST(PeopleFinder, RealRecordingShowsOneWhoIsCutOff) {
  LORICA_REQUIRE_DATASET(file, "oni/3DJ_Test/test.oni");
  std::unique_ptr<OniFile> source = openOni(file).value();
  PeopleFinder finder(source->camera(), 2);
  DepthFrame frame;
  int frames = 0;
  for (; source->next(frame).value() == DepthRead::kFrame; ++frames) {
    finder.find(frame);
    ASSERT_EQ(finder.people().size(), 1U) << frames;  // and a shelf, cut off on the other side, is not a person
    const PersonSegment& one = finder.people()[0];
    EXPECT_EQ(one.user, 1);
    EXPECT_NEAR(one.middle.z(), -0.86, 0.1);
    EXPECT_GT(one.pixelCount, 40'000);
  }
  EXPECT_EQ(frames, 12);
}

}  // namespace
}  // namespace lorica
