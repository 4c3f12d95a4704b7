#include "capture/synthetic/synthetic_motion.h"
#include "tests/capture/files/joint_files.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <tuple>

/// Files in which the header names the joint of every column.
namespace lorica {
namespace {

using J = BodyJoint;

std::vector<SkeletonFrame> walk() {
  std::vector<SkeletonFrame> frames = synthesizeMotion(SyntheticMotion::kWalk);
  frames.resize(30);
  return frames;
}

/// How a program writes: the columns before the joints and their values, the name of a column, the position of a joint.
struct Program {
  std::string_view before, first, axes = "xyz";
  std::string (*column)(std::string_view name, char axis) = [](std::string_view name, char axis) {
    return fmt::format("{}_{}", name, axis);
  };
  Vec3 scale = Vec3::Ones();
  double ticks = 1.0;
  std::string_view confidence = {}, seen = {};  ///< what follows a position: the column's end, its value
  std::function<std::string(std::string_view)> joint = [](std::string_view name) { return std::string(name); };
};

std::string fileOf(const Program& program, const std::vector<SkeletonFrame>& frames) {
  std::string text(program.before);
  for (const std::string_view name : test::kinect2Names()) {
    for (const char axis : program.axes) text += "," + program.column(program.joint(name), axis);
    if (!program.confidence.empty()) text += fmt::format(",{}{}", program.joint(name), program.confidence);
  }
  for (const SkeletonFrame& frame : frames) {
    text += "\n" + fmt::format(fmt::runtime(program.first), frame.time * program.ticks);
    for (const Vec3& p : test::kinectBodyOf(frame)) {
      for (const char axis : program.axes) text += fmt::format(",{:.7g}", program.scale[axis - 'x'] * p[axis - 'x']);
      if (!program.confidence.empty()) text += fmt::format(",{}", program.seen);
    }
  }
  return text + "\n";
}

std::string sideFirst(std::string_view name) {
  for (const std::string_view side : {"Left", "Right"}) {
    if (name.ends_with(side)) return fmt::format("{}_{}", side, name.substr(0, name.size() - side.size()));
  }
  return std::string(name);
}

TEST(JointColumns, AreReadByTheirNames) {
  const std::vector<SkeletonFrame> truth = walk();
  const Vec3 down(-1000, -1000, 1000);  // x to the camera's right, y down
  const std::vector<Program> programs = {
      {.before = "TimeSpan", .first = "{:.4f}", .confidence = "_Conf", .seen = "2"},
      {.before = "timestamp,body_id", .first = "{:.0f},7", .scale = down, .ticks = 1e6},
      {.before = "time_ms",
       .first = "{:.1f}",
       .column = [](std::string_view j, char axis) { return fmt::format("{}.{} [cm]", j, axis); },
       .scale = Vec3::Constant(100),
       .ticks = 1e3,
       .confidence = " tracked",
       .seen = "1"},
      {.before = "frame",
       .first = "{:.0f}",
       .column = [](std::string_view j, char axis) { return fmt::format("{}{}(mm)", j, axis); },
       .scale = Vec3::Constant(1000),
       .ticks = 30,
       .confidence = "-State",
       .seen = "Tracked",
       .joint = sideFirst},
      {.before = "id", .first = "3", .axes = "zyx", .joint = sideFirst}};
  for (const Program& program : programs) {
    const std::string text = fileOf(program, truth);
    SCOPED_TRACE(text.substr(0, 60));
    const Result<JointStream> stream = parseJointStream(text, "walk.csv");
    ASSERT_TRUE(stream) << stream.error().message;
    EXPECT_EQ(stream->format, JointFormat::kNamedColumns);
    ASSERT_EQ(stream->frames.size(), truth.size());
    const Vec3 moved = stream->frames[0][J::kHead].position - truth[0][J::kHead].position;
    for (std::size_t f = 0; f < stream->frames.size(); ++f) {
      EXPECT_NEAR(stream->frames[f].time, truth[f].time, 2e-4);
      for (int j = 0; j < kBodyJointCount; ++j) {
        const TrackedJoint& joint = stream->frames[f].joints[j];
        EXPECT_EQ(joint.confidence, 1.0);
        EXPECT_LT((joint.position - truth[f].joints[j].position - moved).norm(), 1e-5) << f << " " << j;
      }
    }
  }
}

/// A header of six joints; a row of head, neck, and four joints of a leg at the given places.
constexpr std::string_view kSix =
    "time_s,head_x,head_y,head_z,neck_x,neck_y,neck_z,l_hip_x,l_hip_y,l_hip_z,RHip_x,RHip_y,RHip_z,LeftFoot_x,"
    "LeftFoot_y,LeftFoot_z,foot r x,foot r y,foot r z";
std::string rowOf(std::string_view time, std::string_view head, std::string_view neck, std::string_view legs) {
  return fmt::format("{},{},{},{}\n", time, head, neck, legs);
}
constexpr std::string_view kLegs = "0.1,0.9,2,-0.1,0.9,2,0.1,0.1,2,-0.1,0.1,2";

TEST(JointColumns, MayBeFewAndWithoutAnkles) {
  const std::string text =
      fmt::format("{}\n{}{}", kSix, rowOf("1", "0,1.6,2", "0,1.4,2", kLegs), rowOf("2", "0,1.6,2", "0,1.4,2", kLegs));
  const Result<JointStream> stream = parseJointStream(text, "x");
  ASSERT_TRUE(stream) << stream.error().message;
  EXPECT_NEAR(stream->frames[1].time, 1.0, 1e-12);
  EXPECT_NEAR(stream->frames[0][J::kLeftFoot].position.y(), 0.08, 1e-12);
  EXPECT_NEAR(stream->frames[0][J::kHead].position.y(), 1.58, 1e-12);
}

TEST(JointColumns, WhatIsNotSureIsRefused) {
  const auto header = [](std::string_view from, std::string_view to) {
    std::string text(kSix);
    return text.replace(text.find(from), from.size(), to);
  };
  const std::string good = rowOf("0", "0,1.6,2", "0,1.4,2", kLegs);
  const std::tuple<std::string, std::string, std::string> cases[] = {
      {header("head_z", "depth"), good, ", line 1: found 'head_x' without z, expected x, y and z of each joint"},
      {header("time_s", "Head x"), good, ", line 1, column 2 (Head x): found 'head_x', expected one column for this"},
      {header("neck_x", "neck_x_mm"), good,
       ", line 1, column 5 (neck_x_mm): found 'neck_x_mm', expected one unit of length"},
      {std::string(kSix), rowOf("0", "0,7,2", "0,6,2", kLegs),
       ": found people who measure 6.9, expected joints in metres, centimetres or millimetres"},
      {std::string(kSix), rowOf("0", "0,0,1.6", "0,0,1.4", "0.1,0,0.9,-0.1,0,0.9,0.1,0,0.1,-0.1,0,0.1"),
       ": found no heads above or below hips along y, expected y to point up or down"},
      {std::string(kSix), rowOf("0", "0,1.6,up", "0,1.4,2", kLegs),
       ", line 2, column 4 (head_z): found 'up', expected a number"},
      {std::string(kSix), rowOf("noon", "0,1.6,2", "0,1.4,2", kLegs),
       ", line 2, column 1 (time): found 'noon', expected a number"},
      {std::string(kSix), "", ": found a header and no rows, expected at least one"}};
  for (const auto& [names, row, sentence] : cases) {
    const Result<JointStream> stream = parseJointStream(names + "\n" + row, "x");
    EXPECT_EQ(stream ? "accepted" : stream.error().message, "x" + sentence);
  }
  const std::string few = "time,head_x,head_y,head_z,neck_x,neck_y,neck_z\n0,0,1.6,2,0,1.4,2\n";
  EXPECT_FALSE(parseJointStream(few, "x"));
  EXPECT_EQ(parseJointStream(few, "x", {.format = JointFormat::kNamedColumns}).error().message,
            "x, line 1: found a header that names 2 joints, expected at least 6");
  // Numbers instead of names say too little.
  EXPECT_FALSE(parseJointStream("frame,x0,y0,z0,x1,y1,z1,x2,y2,z2\n0,0,1,0,0,1,0,0,0,0\n", "x"));
}

}  // namespace
}  // namespace lorica
