#include "capture/sensor/oni_source.h"
#include "capture/tracking/tracker.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace lorica {
namespace {

/// Left and right shoulder and torso of a person in a frame, camera frame [m].
struct True {
  Vec3 left, right, torso;
};

/// Rows of `frame`, then x, y, z of 15 joints.
std::map<int, True> readTruth(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  std::map<int, True> truth;
  while (std::getline(stream, line)) {
    std::ranges::replace(line, ',', ' ');
    std::istringstream numbers(line);
    int frame = 0;
    numbers >> frame;
    std::array<Vec3, kBodyJointCount> joints;
    for (Vec3& joint : joints) numbers >> joint.x() >> joint.y() >> joint.z();
    const auto of = [&](BodyJoint joint) { return joints[static_cast<std::size_t>(joint)]; };
    truth[frame] = {of(BodyJoint::kLeftShoulder), of(BodyJoint::kRightShoulder), of(BodyJoint::kTorso)};
  }
  return truth;
}

struct Seen {
  int frames = 0, followed = 0;  ///< from one second after the first frame with a person on
  int extra = 0;                 ///< frames with more people than there are
  int back = 0;                  ///< followed with left and right exchanged
  int first = -1;                ///< frame with a person
};

Seen follow(const std::filesystem::path& oni, const std::vector<std::map<int, True>>& people, int seconds) {
  const std::unique_ptr<OniSource> source = openOni(oni).value();
  Tracker tracker = Tracker::create(source->camera()).value();
  Seen seen;
  const int start = people.empty() ? 0 : people[0].begin()->first;
  DepthFrame depth;
  for (int frame = 0; source->next(depth).value() == DepthRead::kFrame; ++frame) {
    const auto tracked = tracker.track(depth);
    if (!tracked.empty() && seen.first < 0) seen.first = frame;
    if (frame < start + seconds) continue;
    seen.extra += static_cast<int>(tracked.size() > std::max<std::size_t>(1, people.size()));
    const Isometry3 cameraFromFloor = tracker.floorFromCamera().inverse();
    for (const std::map<int, True>& person : people) {
      const auto truth = person.find(frame);
      if (truth == person.end()) continue;
      ++seen.frames;
      for (const TrackedPerson& one : tracked) {
        const auto at = [&](BodyJoint joint) -> Vec3 { return cameraFromFloor * one.skeleton[joint].position; };
        if ((at(BodyJoint::kTorso) - truth->second.torso).norm() > 0.3) continue;
        ++seen.followed;
        const Vec3 across = at(BodyJoint::kLeftShoulder) - at(BodyJoint::kRightShoulder);
        seen.back += static_cast<int>(across.dot(truth->second.left - truth->second.right) < 0.0);
        break;
      }
    }
  }
  return seen;
}

TEST(RealPeople, AreFollowedFacingTheCameraAndFurnitureIsNobody) {
  for (const std::string name : {"cut_a7_s1", "cut_a19_s5", "A_armchair3_a9s1", "A_sofa_a11s7", "B_armchair2_a26s7"}) {
    SCOPED_TRACE(name);
    LORICA_REQUIRE_DATASET(oni, "depth_real/" + name + ".oni");
    const auto truth = readTruth(oni.parent_path() / (name + ".joints.csv"));
    const Seen seen = follow(oni, {truth}, 30);
    EXPECT_EQ(seen.followed, seen.frames);
    EXPECT_EQ(seen.extra, 0);
    EXPECT_EQ(seen.back, 0);
  }
}

TEST(RealPeople, TwoWhoTouchAreTwo) {
  const std::string name = "C_sofa_a19s1_a10s7";
  LORICA_REQUIRE_DATASET(oni, "depth_real/" + name + ".oni");
  const Seen seen = follow(
      oni,
      {readTruth(oni.parent_path() / (name + ".joints.csv")), readTruth(oni.parent_path() / (name + ".joints2.csv"))},
      30);
  EXPECT_GE(seen.followed, seen.frames * 95 / 100);
  EXPECT_EQ(seen.extra, 0);
  EXPECT_LE(seen.back, seen.frames / 50);
}

TEST(RealPeople, SomeoneOnASofaIsFoundInTwoSeconds) {
  LORICA_REQUIRE_DATASET(oni, "depth_real/realsense_point.oni");
  const Seen seen = follow(oni, {}, 10);
  EXPECT_GE(seen.first, 0);
  EXPECT_LE(seen.first, 20);
  EXPECT_EQ(seen.extra, 0);
}

}  // namespace
}  // namespace lorica
