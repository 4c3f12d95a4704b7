#include "capture/synthetic/synthetic_motion.h"
#include "tests/capture/files/joint_files.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace lorica {
namespace {

using test::BodiesRow;

constexpr std::size_t kComes = 30, kLeaves = 60, kEnd = 90;  // frames of the second person, and of the first

/// The first of two waves all the time, 0.6 m to the left of the middle; the second is there for a second, 0.6 m to the
/// right.
struct TwoPeople {
  std::vector<SkeletonFrame> first = at(-0.6, SyntheticMotion::kWave);
  std::vector<SkeletonFrame> second = at(0.6, SyntheticMotion::kJumpingJacks);

  static std::vector<SkeletonFrame> at(double x, SyntheticMotion motion) {
    std::vector<SkeletonFrame> frames = synthesizeMotion(motion);
    frames.resize(kEnd);
    for (SkeletonFrame& frame : frames) {
      for (TrackedJoint& joint : frame.joints) joint.position.x() += x;
    }
    return frames;
  }

  [[nodiscard]] std::string file() const {
    std::vector<BodiesRow> rows;
    for (std::size_t f = 0; f < kEnd; ++f) {
      BodiesRow& row = rows.emplace_back(BodiesRow{.ticks = static_cast<std::int64_t>(std::lround(f * 1e7 / 30.0))});
      row.bodies[0] = &first[f];
      if (f >= kComes && f < kLeaves) row.bodies[3] = &second[f];
    }
    return test::bodiesFile(rows);
  }
};

double middleOf(const SkeletonFrame& frame) {
  return 0.5 * (frame[BodyJoint::kLeftHip].position.x() + frame[BodyJoint::kRightHip].position.x());
}

TEST(JointStreamOfAll, KeepsWhereAndWhenPeopleWere) {
  const test::TemporaryFolder folder;
  const TwoPeople two;
  const std::vector<JointStream> all = readJointStreamOfAll(folder.write("two.txt", two.file())).value();
  ASSERT_EQ(all.size(), 2u);
  ASSERT_EQ(all[0].frames.size(), kEnd);
  ASSERT_EQ(all[1].frames.size(), kEnd);
  for (std::size_t f = 0; f < kEnd; ++f) {
    const SkeletonFrame &first = all[0].frames[f], &second = all[1].frames[f];
    EXPECT_NEAR(first.time, static_cast<double>(f) / 30.0, 1e-3);
    EXPECT_NEAR(second.time, first.time, 1e-3);
    EXPECT_NE(first.user, kNobody);
    EXPECT_EQ(second.user == kNobody, f < kComes || f >= kLeaves) << f;
    if (second.user == kNobody) continue;
    const double truth = middleOf(two.second[f]) - middleOf(two.first[f]);
    EXPECT_NEAR(middleOf(second) - middleOf(first), truth, 1e-3) << f;
  }
}

TEST(JointStreamOfAll, OfOnePersonIsTheStream) {
  const test::TemporaryFolder folder;
  const std::vector<SkeletonFrame> frames = TwoPeople().first;
  const std::filesystem::path file = folder.write("one.txt", test::msrFile(frames));
  const std::vector<JointStream> all = readJointStreamOfAll(file).value();
  const JointStream one = readJointStream(file).value();
  ASSERT_EQ(all.size(), 1u);
  ASSERT_EQ(all[0].frames.size(), one.frames.size());
  for (std::size_t f = 0; f < one.frames.size(); ++f) {
    EXPECT_NEAR(all[0].frames[f].time, one.frames[f].time, 1e-9);
    const Vec3 off = all[0].frames[f][BodyJoint::kHead].position - one.frames[f][BodyJoint::kHead].position;
    EXPECT_LT(off.norm(), 1e-9);
  }
}

TEST(JointStreamOfAll, OfACrowdIsRefused) {
  const test::TemporaryFolder folder;
  std::ifstream walk(test::recordingsFolder() / "walk.csv");
  std::string header, row;
  std::getline(walk, header);
  std::getline(walk, row);
  std::string text = header + "\n";
  const std::string joints = row.substr(row.find(',', row.find(',') + 1));
  for (int user = 1; user <= 65; ++user) text += "0," + std::to_string(user) + joints + "\n";
  const Result<std::vector<JointStream>> all = readJointStreamOfAll(folder.write("crowd.csv", text));
  ASSERT_FALSE(all.ok());
  EXPECT_NE(all.error().message.find("found 65 people, expected at most 64"), std::string::npos) << all.error().message;
}

}  // namespace
}  // namespace lorica
