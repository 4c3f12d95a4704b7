#include "capture/files/joint_csv.h"
#include "capture/tracking/segmentation/person_network.h"
#include "capture/tracking/tracker.h"
#include "capture/virtual_sensor/virtual_performer.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lorica {
namespace {

constexpr double kBack = -0.14;  ///< z of a standing mannequin's back and heels [m]

/// A room whose wall or furniture is this far behind a person who stands at the origin [m].
VirtualRoom wallBehind(double gap) {
  VirtualRoom room;
  room.wall = kBack - gap;
  return room;
}
VirtualRoom sofaBehind(double gap) {
  VirtualRoom room;
  const double front = kBack - gap;
  room.boxes.push_back({Vec3(-1.0, 0.0, front - 0.8), Vec3(1.0, 0.42, front)});
  room.boxes.push_back({Vec3(-1.0, 0.0, front - 0.8), Vec3(1.0, 0.85, front - 0.5)});
  return room;
}
VirtualRoom shelfBehind(double gap) {
  VirtualRoom room;
  const double front = kBack - gap;
  room.boxes.push_back({Vec3(-0.7, 0.0, front - 0.4), Vec3(0.5, 1.9, front)});
  return room;
}

/// A desk that hides the legs, this far before a person's belly [m].
VirtualRoom deskBefore(double gap) {
  VirtualRoom room;
  room.boxes.push_back({Vec3(-0.8, 0.0, 0.14 + gap), Vec3(0.8, 0.74, 0.84 + gap)});
  return room;
}

DepthNoiseSettings kinect() {
  DepthNoiseSettings noise;
  noise.seed = 1;
  return noise;
}

struct Followed {
  int from = -1;         ///< first frame
  double overlap = 0.0;  ///< mean intersection over union of labels, from one second on
  double error = 0.0;    ///< mean of all joints from one second on [m]
  int extra = 0;         ///< frames with more than one person
  int uncertain = 0;     ///< frames in which person and room cannot be told apart
};

Followed follow(const VirtualRoom& room, std::string_view motion, const DepthNoiseSettings& noise, int frames) {
  std::vector<VirtualPerson> people;
  people.push_back({VirtualPerformer::create(makeMannequin(), shippedFrames(motion)).value()});
  VirtualSensorSettings settings;
  settings.room = room;
  settings.noise = noise;
  VirtualSensor sensor = VirtualSensor::create(std::move(people), settings).value();
  Tracker tracker = Tracker::create(sensor.camera()).value();
  DepthFrame frame;
  Followed followed;
  int late = 0;
  for (int f = 0; f < frames; ++f) {
    sensor.render(static_cast<std::uint64_t>(f), frame);
    const auto tracked = tracker.track(frame);
    if (!tracked.empty() && followed.from < 0) followed.from = f;
    followed.extra += static_cast<int>(tracked.size() > 1);
    followed.uncertain += static_cast<int>(tracker.roomUncertain());
    if (f < 30) continue;
    ++late;
    int both = 0, either = 0;
    const auto labels = tracker.labels();
    for (std::size_t i = 0; i < sensor.labels().size(); ++i) {
      if (labels[i] == 255) continue;
      const bool truth = sensor.labels()[i] != 0, found = labels[i] != 0;
      both += static_cast<int>(truth && found);
      either += static_cast<int>(truth || found);
    }
    followed.overlap += static_cast<double>(both) / std::max(1, either);
    if (tracked.empty()) {
      followed.error += 1.0;
      continue;
    }
    const SkeletonFrame truth = moved(sensor.truth()[0].joints, sensor.floorFromCamera());
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      followed.error += (tracked[0].skeleton.joints[j].position - truth.joints[j].position).norm() / kBodyJointCount;
    }
  }
  followed.overlap /= late;
  followed.error /= late;
  return followed;
}

/// Expects that the person, and nobody else, is followed from one of the first frames on.
void expectFollowed(const Followed& seen, int latest, double largestError) {
  EXPECT_GE(seen.from, 0);
  EXPECT_LE(seen.from, latest);
  EXPECT_GE(seen.overlap, 0.9);
  EXPECT_LE(seen.error, largestError);
  EXPECT_EQ(seen.extra, 0);
}

TEST(TrackerInRooms, FindsWhoeverStandsBeforeAWallOrFurnitureFromTheFirstFrame) {
  for (const double gap : {0.05, 0.15, 0.30}) {
    for (const auto& [name, room] : {std::pair{"wall", wallBehind(gap)}, std::pair{"sofa", sofaBehind(gap)},
                                     std::pair{"shelf", shelfBehind(gap)}}) {
      for (const std::string_view motion : {"wave", "jumping_jacks"}) {
        if (motion == "jumping_jacks" && gap > 0.1) continue;
        const Followed seen = follow(room, motion, kinect(), 45);
        SCOPED_TRACE(std::string(name) + " at " + std::to_string(gap) + ", " + std::string(motion));
        expectFollowed(seen, 30, 0.04);
        EXPECT_EQ(seen.uncertain, 0);
      }
    }
  }
}

TEST(TrackerInRooms, FindsWhoeverTouchesFurnitureWithNothingMissingBetween) {
  DepthNoiseSettings noise = kinect();
  noise.baseline = noise.edgeLoss = 0.0;  // no shadow beside people, as of stereo and time of flight
  VirtualRoom room = sofaBehind(0.0);
  room.boxes.push_back({Vec3(0.28, 0.0, -0.5), Vec3(0.9, 1.1, 0.1)});
  for (const std::string_view motion : {"wave", "punch_and_kick"}) {
    const Followed seen = follow(room, motion, noise, 60);
    SCOPED_TRACE(std::string(motion));
    expectFollowed(seen, 15, 0.06);
  }
}

TEST(TrackerInRooms, FindsWhoeverStandsFlushWithACupboardAtOnce) {
  DepthNoiseSettings noise = kinect();
  noise.baseline = noise.edgeLoss = 0.0;
  for (const double front : {-0.08, 0.04}) {
    VirtualRoom room;  // person and cupboard are one surface, most of it the cupboard's
    room.boxes.push_back({Vec3(-0.95, 0.0, -0.6), Vec3(-0.2, 1.8, front)});
    for (const std::string_view motion : {"wave", "punch_and_kick"}) {
      const Followed seen = follow(room, motion, noise, 45);
      SCOPED_TRACE(std::to_string(front) + ", " + std::string(motion));
      EXPECT_GE(seen.from, 0);
      EXPECT_LE(seen.from, 15);
      EXPECT_GE(seen.overlap, 0.85);
      EXPECT_LE(seen.error, 0.04);
      EXPECT_EQ(seen.extra, 0);
    }
  }
}

TEST(TrackerInRooms, FollowsWhoeverStandsBehindADesk) {
  for (const double gap : {0.0, 0.15}) {
    for (const std::string_view motion : {"wave", "punch_and_kick"}) {
      const Followed seen = follow(deskBefore(gap), motion, kinect(), 50);
      SCOPED_TRACE(std::to_string(gap) + ", " + std::string(motion));
      expectFollowed(seen, 30, 0.1);
    }
  }
}

/// What the shipped network says of an image, and what is true: intersection over union of the person's pixels.
double overlapOfNetwork(const VirtualRoom& room, std::string_view motion, std::uint64_t number) {
  std::vector<VirtualPerson> people;
  people.push_back({VirtualPerformer::create(makeMannequin(), shippedFrames(motion)).value()});
  VirtualSensorSettings settings;
  settings.room = room;
  settings.noise = kinect();
  VirtualSensor sensor = VirtualSensor::create(std::move(people), settings).value();
  DepthFrame frame;
  sensor.render(number, frame);
  // A quarter of the image along each side, in the middle of the network's.
  constexpr int kWidth = PersonNetwork::kWidth, kHeight = PersonNetwork::kHeight;
  const DepthCamera& camera = sensor.camera();
  const int step = camera.width / kWidth, top = (kHeight - camera.height / step) / 2;
  std::vector<std::uint16_t> depthMm(std::size_t{kWidth} * kHeight);
  std::vector<std::int16_t> heightMm(depthMm.size());
  std::vector<std::uint8_t> isPerson(depthMm.size());
  for (int v = top; v < kHeight - top; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const int column = step * u, row = step * (v - top);
      const std::size_t from = static_cast<std::size_t>(row) * camera.width + column;
      const std::size_t to = static_cast<std::size_t>(v) * kWidth + u;
      const double depth = 1e-3 * frame.depthMm[from];
      const Vec3 ray((column + 0.5 - 0.5 * camera.width) / camera.focalX(),
                     -(row + 0.5 - 0.5 * camera.height) / camera.focalY(), -1.0);
      depthMm[to] = frame.depthMm[from];
      heightMm[to] = static_cast<std::int16_t>(1e3 * (sensor.floorFromCamera() * (depth * ray)).y());
      isPerson[to] = sensor.labels()[from];
    }
  }
  PersonNetwork network = PersonNetwork::shipped();
  const std::span<const std::int16_t> logits = network.run(depthMm, heightMm, true);
  int both = 0, either = 0;
  for (std::size_t i = 0; i < logits.size(); ++i) {
    if (depthMm[i] == 0) continue;
    both += static_cast<int>(isPerson[i] != 0 && logits[i] > 0);
    either += static_cast<int>(isPerson[i] != 0 || logits[i] > 0);
  }
  return static_cast<double>(both) / std::max(1, either);
}

TEST(TrackerInRooms, TheShippedNetworkTellsThePersonFromTheRoom) {
  for (const auto& [name, room] : {std::pair{"wall", wallBehind(0.05)}, std::pair{"sofa", sofaBehind(0.05)},
                                   std::pair{"shelf", shelfBehind(0.05)}, std::pair{"desk", deskBefore(0.0)}}) {
    for (const std::uint64_t number : {0U, 40U}) {
      EXPECT_GE(overlapOfNetwork(room, "punch_and_kick", number), 0.93) << name << ", " << number;
    }
  }
}

/// Of someone's shin that shows between an arm rest and a person in front.
struct SeenShin {
  int from = -1;       ///< first frame in which both people are followed
  double own = 0.0;    ///< share of its pixels that are labelled as the person's, from one second on
  double other = 0.0;  ///< as the person's in front
  double foot = 0.0;   ///< mean error of the foot [m]
};

SeenShin followBehindAnArmRest(std::uint64_t seed, int frames) {
  std::vector<VirtualPerson> people;
  for (const Vec3& place : {Vec3(0.36, 0.0, 0.2), Vec3(0.0, 0.0, 0.0)}) {
    people.push_back({VirtualPerformer::create(makeMannequin(), shippedFrames("wave")).value()});
    people.back().worldFromMotion.translation() = place;
    people.back().start = people.size() == 1 ? 0.0 : 1.0;
  }
  VirtualSensorSettings settings;
  settings.room.boxes.push_back({Vec3(-0.6, 0.0, 0.15), Vec3(0.02, 0.68, 0.6)});
  settings.room.boxes.push_back({Vec3(-0.6, 0.57, 0.15), Vec3(0.3, 0.68, 0.3)});
  settings.noise.seed = seed;
  settings.loop = true;
  VirtualSensor sensor = VirtualSensor::create(std::move(people), settings).value();
  Tracker tracker = Tracker::create(sensor.camera()).value();
  DepthFrame frame;
  SeenShin seen;
  const int late = frames - 30;
  for (int f = 0; f < frames; ++f) {
    sensor.render(static_cast<std::uint64_t>(f), frame);
    const auto tracked = tracker.track(frame);
    if (tracked.size() == 2 && seen.from < 0) seen.from = f;
    if (f < 30) continue;
    const auto truth = sensor.labels(), labels = tracker.labels();
    const auto w = static_cast<std::size_t>(sensor.camera().width);
    // Below the arm rest's top at the person's distance; their labels are those above it.
    const auto edge = static_cast<std::size_t>(
        sensor.camera().imagePointOf(sensor.floorFromCamera().inverse() * Vec3(0.0, 0.6, -3.0)).y());
    std::array<std::array<int, 256>, 3> above{}, below{};
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (labels[i] != 255) ++(i / w < edge ? above : below)[truth[i]][labels[i]];
    }
    const auto labelOf = [&](std::size_t person) {
      return std::max_element(above[person].begin() + 1, above[person].end()) - above[person].begin();
    };
    const std::array<int, 256>& shin = below[2];
    const double pixels = std::max(1, std::accumulate(shin.begin(), shin.end(), 0));
    seen.own += shin[labelOf(2)] / pixels / late;
    seen.other += shin[labelOf(1)] / pixels / late;
    const SkeletonFrame joints = moved(sensor.truth()[1].joints, sensor.floorFromCamera());
    const Vec3 foot = joints[BodyJoint::kLeftFoot].position;
    double off = 1.0;
    for (const TrackedPerson& person : tracked) {
      off = std::min(off, (person.skeleton[BodyJoint::kLeftFoot].position - foot).norm());
    }
    seen.foot += off / late;
  }
  return seen;
}

TEST(TrackerInRooms, LegBesideAnArmRestIsThatOfThePersonBehind) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const SeenShin seen = followBehindAnArmRest(seed, 60);
    SCOPED_TRACE(seed);
    EXPECT_GE(seen.from, 0);
    EXPECT_LE(seen.from, 30);
    EXPECT_GE(seen.own, 0.8);
    EXPECT_LE(seen.other, 0.05);
    EXPECT_LE(seen.foot, 0.1);
  }
}

}  // namespace
}  // namespace lorica
