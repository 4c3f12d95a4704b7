#include "capture/files/joint_csv.h"
#include "capture/files/joint_stream.h"
#include "geometry/counts.h"
#include "tests/capture/files/joint_files.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <tuple>

/// Files in which the header names the joint of every column.
namespace lorica {
namespace {

using J = BodyJoint;
using test::kLandmarks;
using test::landmarkOf;

std::vector<SkeletonFrame> walk() {
  std::vector<SkeletonFrame> frames = shippedFrames("walk");
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
      {.before = "id", .first = "3", .axes = "zyx", .joint = sideFirst},
      {.before = "Zeit [ms]", .first = "{:.2f}", .ticks = 1e3, .confidence = " Conf", .seen = "95"},
      {.before = "tiempo (s)", .first = "{:.4f}", .confidence = "_score", .seen = "80 %"}};
  for (const Program& program : programs) {
    const std::string text = fileOf(program, truth);
    SCOPED_TRACE(text.substr(0, 60));
    const JointStream stream = test::valueOf(parseJointStream(text, "walk.csv"));
    EXPECT_EQ(stream.format, JointFormat::kNamedColumns);
    ASSERT_EQ(stream.frames.size(), truth.size());
    const Vec3 moved = stream.frames[0][J::kHead].position - truth[0][J::kHead].position;
    for (std::size_t f = 0; f < stream.frames.size(); ++f) {
      EXPECT_NEAR(stream.frames[f].time, truth[f].time, 2e-4);
      for (int j = 0; j < kBodyJointCount; ++j) {
        const TrackedJoint& joint = stream.frames[f].joints[j];
        EXPECT_EQ(joint.confidence, 1.0);
        EXPECT_LT((joint.position - truth[f].joints[j].position - moved).norm(), 1e-5) << f << " " << j;
      }
    }
  }
}

/// Excel in most of Europe: semicolons, decimal commas, quotes, confidences in percent.
TEST(JointColumns, ConfidencesMayBePercents) {
  const std::vector<SkeletonFrame> truth = walk();
  const auto column = [](std::string_view j, char axis) { return fmt::format("\"{} {}\"", j, axis); };
  const Program excel = {
      .before = "\"Zeit [ms]\"", .first = "{:.2f}", .column = column, .ticks = 1e3, .confidence = " Conf", .seen = "P"};
  std::string text = fileOf(excel, truth);
  std::ranges::replace(text, ',', ';');
  std::ranges::replace(text, '.', ',');
  // Sure in every third place, then guessed, then lost.
  constexpr std::array kPercents = {"100", "12,5", "3"};
  for (std::size_t at = text.find('P', text.find('\n')), i = 0; at != std::string::npos; at = text.find('P', at)) {
    text.replace(at, 1, kPercents[i++ % 3]);
  }
  const JointStream stream = test::valueOf(parseJointStream(text, "walk.csv"));
  ASSERT_EQ(stream.frames.size(), truth.size());
  std::map<double, int> seen;
  for (std::size_t f = 0; f < truth.size(); ++f) {
    EXPECT_NEAR(stream.frames[f].time, truth[f].time, 2e-5);
    for (const TrackedJoint& joint : stream.frames[f].joints) ++seen[joint.confidence];
  }
  EXPECT_EQ(seen.size(), 3u);
  for (const double confidence : {0.0, 0.5, 1.0}) EXPECT_GT(seen[confidence], 60) << confidence;
  text.replace(text.find(";100;"), 5, ";101;");
  EXPECT_NE(parseJointStream(text, "x").error().message.find(
                "found '101', expected a confidence from 0 to 1 or 100, or a state of 0, 1 or 2"),
            std::string::npos);
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
  const JointStream stream = test::valueOf(parseJointStream(text, "x"));
  EXPECT_NEAR(stream.frames[1].time, 1.0, 1e-12);
  EXPECT_NEAR(stream.frames[0][J::kLeftFoot].position.y(), 0.08, 1e-12);
  EXPECT_NEAR(stream.frames[0][J::kHead].position.y(), 1.58, 1e-12);
}

TEST(JointColumns, MayStandBelowRemarks) {
  const std::string rows = rowOf("1", "0,1.6,2", "0,1.4,2", kLegs) + rowOf("2", "0,1.6,2", "0,1.4,2", kLegs);
  for (const std::string_view before : {"# ", "Recorded by a program\n\nsubject,7\n", "%rate 30\r\n#"}) {
    const JointStream stream = test::valueOf(parseJointStream(fmt::format("{}{}\n{}", before, kSix, rows), "x"));
    EXPECT_EQ(stream.frames.size(), 2u);
  }
  EXPECT_EQ(parseJointStream(fmt::format("a remark\n#{}\n{}", kSix, "1,2\n" + rows), "x").error().message,
            "x, line 3: found 2 fields, expected 19 as in the header");
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
       ": found people who measure 7.8, expected 1 to 2.3 metres in any unit"},
      {std::string(kSix), rowOf("0", "1,1,1", "0.9,0.9,0.9", "0.6,0.5,0.5,0.5,0.6,0.5,0.1,0,0.1,0,0.1,0.1"),
       ": found no heads above or below hips along x, y or z, expected one of them to point up or down"},
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

/// Azure Kinect's 32 joints by those of Kinect v2; collar bones and faces are where others are.
constexpr std::array kAzureAs = {0,  1,  20, 2,  20, 4,  5,  6,  7,  21, 22, 20, 8, 9, 10, 11,
                                 23, 24, 12, 13, 14, 15, 16, 17, 18, 19, 3,  3,  3, 3, 3,  3};

/// A program that writes a row for each joint, with its number.
struct NumberedRows {
  std::string_view header, row;  ///< {0}: time [s], {1}: number, {2}, {3}, {4}: position
  int count = 25, first = 0;
  std::string_view sensor = "Kinect v2";
  double ticks = 1.0;
  std::vector<int> absent = {};
};

TEST(JointColumns, RowsMayNumberJointsAsTheSensorDoes) {
  const std::vector<SkeletonFrame> truth = walk();
  const std::vector<NumberedRows> programs = {
      {"Timestamp, JointID, Position.X, Position.Y, Position.Z, Orientation.X, Orientation.Y, Orientation.Z, "
       "Orientation.W, State",
       "{0:.1f}, {1}, {2:.6f}, {3:.6f}, {4:.6f}, 0, 0, 0, 1, 2", 25, 0, "Kinect v2", 1e3},
      {"frame;joint_index;x;y;z;confidence", "{0:.0f};{1};{2:.6f};{3:.6f};{4:.6f};90", 25, 1, "Kinect v2", 30.0},
      {"z\ty\tx\tjoint number\ttime_s", "{4:.6f}\t{3:.6f}\t{2:.6f}\t{1}\t{0:.4f}", 20, 0, "Kinect v1"},
      {"Time(ms),JointType,X,Y,Z", "{0:.1f},{1},{2:.6f},{3:.6f},{4:.6f}", 20, 0, "Kinect v1", 1e3},
      {"t,joint,x,y,z", "{0:.4f},{1},{2:.6f},{3:.6f},{4:.6f}", 32, 0, "Azure Kinect"},
      {"frame,id,x,y,z,conf", "{0:.0f},{1},{2:.6f},{3:.6f},{4:.6f},1", 25, 0, "Kinect v2", 30.0},
      {"t,joint_id,x,y,z", "{0:.4f},{1},{2:.6f},{3:.6f},{4:.6f}", 32, 1, "Azure Kinect"},
      {"t,Joint,x,y,z", "{0:.4f},{1},{2:.6f},{3:.6f},{4:.6f}", 25, 0, "Kinect v2", 1.0, {0, 21, 22, 23}}};
  for (const NumberedRows& program : programs) {
    std::string text = std::string(program.header) + '\n';
    for (const SkeletonFrame& frame : truth) {
      const test::KinectBody body = test::kinectBodyOf(frame);
      for (int j = 0; j < program.count; ++j) {
        if (std::ranges::find(program.absent, j) != program.absent.end()) continue;
        const Vec3& p = body[program.count == 32 ? kAzureAs[j] : j];
        text +=
            fmt::format(fmt::runtime(program.row), frame.time * program.ticks, j + program.first, p.x(), p.y(), p.z()) +
            '\n';
      }
    }
    SCOPED_TRACE(text.substr(0, 80));
    const JointStream stream = test::valueOf(parseJointStream(text, "walk.csv"));
    EXPECT_EQ(stream.format, JointFormat::kKinect1Long);
    const std::string note = fmt::format("The rows number joints: they were taken in {}'s order.", program.sensor);
    EXPECT_EQ(std::ranges::count(stream.notes, note), 1) << testing::PrintToString(stream.notes);
    ASSERT_EQ(stream.frames.size(), truth.size());
    const Vec3 moved = stream.frames[0][J::kHead].position - truth[0][J::kHead].position;
    for (std::size_t f = 0; f < truth.size(); ++f) {
      EXPECT_NEAR(stream.frames[f].time, truth[f].time, 2e-4);
      for (int j = 0; j < kBodyJointCount; ++j) {
        const TrackedJoint& joint = stream.frames[f].joints[j];
        EXPECT_EQ(joint.confidence, 1.0);
        EXPECT_LT((joint.position - truth[f].joints[j].position - moved).norm(), 1e-5) << f << " " << j;
      }
    }
  }
}

constexpr std::string_view kMetres = "metres, since the body measures 1.74 (1.74 m)";

struct Exporter {
  std::string_view time, written;  ///< its column, and how it is written; empty: numbers of frames
  std::string (*column)(int landmark, char axis);
  std::string_view visibility = {};
  Vec3 (*point)(const Vec3& world) = nullptr;  ///< in another unit
  std::string_view guess = kMetres;
  double tolerance = 1e-5;
  char separator = ',';
};

std::string landmarkName(int landmark) {
  return std::string(kLandmarks[landmark]);
}

std::string timeOf(std::string_view form, double time) {
  if (form == "iso") return fmt::format("2024-02-29T23:59:59.{:03.0f}Z", 1e3 * time);
  if (form == "clock") return fmt::format("00:00:{:09.6f}", time);
  return fmt::format(fmt::runtime(form), form.find("ms") != std::string_view::npos ? 1e3 * time : time);
}

TEST(JointColumns, OfLandmarksAreReadByNameOrNumber) {
  std::vector<SkeletonFrame> truth = walk();
  truth.resize(29);  // less than a second
  const std::vector<Exporter> exporters = {
      {"frame", "", [](int i, char axis) { return fmt::format("{}{}", axis, i); }, "v"},
      {"frame", "", [](int i, char axis) { return fmt::format("{}{}", axis, i + 1); }},
      {"t", "{:.4f}", [](int i, char axis) { return fmt::format("landmark_{}_{}", i, axis); }},
      {"time [s]", "{:.4f}", [](int i, char axis) { return fmt::format("pose_landmarks[{}].{}", i, axis); }},
      {"timestamp", "iso", [](int i, char axis) { return fmt::format("{}_{}", landmarkName(i), axis); }, "visibility"},
      {"Time",
       "clock",
       [](int i, char axis) { return fmt::format("{} {}", axis, landmarkName(i)); },
       "vis",
       {},
       kMetres,
       1e-5,
       '\t'},
      {"datetime",
       "iso",
       [](int i, char axis) { return fmt::format("\"{}.{}\"", landmarkName(i), axis); },
       {},
       {},
       kMetres,
       1e-5,
       ';'},
      {"frame", "", [](int i, char axis) { return fmt::format("{}_{}", landmarkName(i), axis); }, "visibility",
       [](const Vec3& world) {
         return Vec3(0.5 + 0.2 * world.x(), 0.5 + 0.2 * 16.0 / 9.0 * world.y(), 0.2 * world.z());
       },
       "fractions of a 16:9 picture, since z is 0 at the hips: scaled to a body of 1.7 m", 0.03},
      {"frame",
       "",
       [](int i, char axis) { return fmt::format("{}{}", axis, i); },
       {},
       [](const Vec3& world) { return Vec3(320 + 140 * world.x(), 240 + 140 * world.y(), 140 * world.z()); },
       "pixels, since z is 0 at the hips: scaled to a body of 1.7 m",
       0.03}};
  for (const Exporter& exporter : exporters) {
    std::string text(exporter.time);
    for (int i = 0; i < countOf(kLandmarks); ++i) {
      for (const char axis : {'x', 'y', 'z'}) text += exporter.separator + exporter.column(i, axis);
      if (exporter.visibility == "v")
        text += fmt::format("{}v{}", exporter.separator, i);
      else if (!exporter.visibility.empty())
        text += fmt::format("{}{} {}", exporter.separator, landmarkName(i), exporter.visibility);
    }
    for (int f = 0; f < countOf(truth); ++f) {
      text += "\n" + (exporter.written.empty() ? fmt::format("{}", f) : timeOf(exporter.written, truth[f].time));
      for (int i = 0; i < countOf(kLandmarks); ++i) {
        const Vec3 p = exporter.point ? exporter.point(landmarkOf(truth[f], i)) : landmarkOf(truth[f], i);
        text += fmt::format("{0}{1:.7f}{0}{2:.7f}{0}{3:.7f}", exporter.separator, p.x(), p.y(), p.z());
        if (!exporter.visibility.empty()) text += fmt::format("{}0.98", exporter.separator);
      }
    }
    SCOPED_TRACE(text.substr(0, 60));
    const JointStream stream = test::valueOf(parseJointStream(text + "\n", "walk.csv"));
    EXPECT_EQ(stream.firstGuess.at(0), exporter.guess);
    ASSERT_EQ(stream.frames.size(), truth.size());
    for (std::size_t f = 0; f < truth.size(); ++f) {
      const SkeletonFrame& read = stream.frames[f];
      EXPECT_NEAR(read.time, truth[f].time, 1e-3);
      const Vec3 moved = read[J::kRightHip].position - truth[f][J::kRightHip].position;
      for (int j = 0; j < kBodyJointCount; ++j) {
        const auto joint = static_cast<J>(j);
        EXPECT_EQ(read[joint].confidence, 1.0);
        if (joint == J::kNeck || joint == J::kTorso) continue;  // between shoulders and hips, which is not their place
        EXPECT_LT((read[joint].position - truth[f][joint].position - moved).norm(), exporter.tolerance)
            << f << " " << j;
      }
      // It stands on its lower foot.
      const auto foot = [&](J side) { return read[side].position.y(); };
      if (exporter.point == nullptr) {
        EXPECT_NEAR(std::min(foot(J::kLeftFoot), foot(J::kRightFoot)), 0.08, 1e-9);
      }
    }
  }
}

TEST(JointColumns, MayBeALandmarkPerRow) {
  const std::vector<SkeletonFrame> truth = walk();
  for (const bool named : {true, false}) {
    std::string text = "frame,person_id,landmark,x,y,z,visibility\n";
    for (int f = 0; f < countOf(truth); ++f) {
      for (const int person : {7, 9}) {
        for (int i = 0; i < countOf(kLandmarks); ++i) {
          const Vec3 p = landmarkOf(truth[person == 7 ? f : 0], i) + Vec3(person - 8, 0, 3);
          text += fmt::format("{},{},{},{},{},{},0.9\n", f, person, named ? landmarkName(i) : std::to_string(i), p.x(),
                              p.y(), p.z());
        }
      }
    }
    const JointStream stream = test::valueOf(parseJointStream(text, "walk.csv"));
    EXPECT_EQ(stream.people, (std::vector<int>{1, 2}));
    ASSERT_EQ(stream.frames.size(), truth.size());
    const auto arm = [](const SkeletonFrame& frame) {
      return Vec3(frame[J::kLeftElbow].position - frame[J::kLeftShoulder].position);
    };
    const JointStream moving = *parseJointStream(text, "walk.csv", {.person = 1});
    EXPECT_LT((arm(moving.frames[20]) - arm(truth[20])).norm(), 1e-5);
  }
}

TEST(JointColumns, FingersThatAProgramFilledInMoveNoHand) {
  const std::vector<SkeletonFrame> truth = walk();
  std::string text = "frame";
  for (int i = 0; i < countOf(kLandmarks); ++i) text += fmt::format(",x{0},y{0},z{0}", i);
  for (int f = 0; f < countOf(truth); ++f) {
    text += fmt::format("\n{}", f);
    for (int i = 0; i < countOf(kLandmarks); ++i) {
      const Vec3 p = landmarkOf(truth[f], i >= 17 && i <= 22 ? 0 : i);  // at the nose
      text += fmt::format(",{},{},{}", p.x(), p.y(), p.z());
    }
  }
  const JointStream stream = test::valueOf(parseJointStream(text + "\n", "walk.csv"));
  const auto arm = [](const SkeletonFrame& frame) {
    return Vec3(frame[J::kLeftHand].position - frame[J::kLeftShoulder].position);
  };
  EXPECT_LT((arm(stream.frames[10]) - arm(truth[10])).norm(), 1e-5);
}

TEST(JointColumns, UpMayBeAnyAxis) {
  const std::vector<SkeletonFrame> truth = walk();
  const std::tuple<Vec3 (*)(const Vec3&), std::string_view> worlds[] = {
      {[](const Vec3& p) { return Vec3(p.z(), p.x(), p.y()); }, "Z is up, rotated so that Y is up"},
      {[](const Vec3& p) { return Vec3(-p.y(), p.z(), -p.x()); }, "X is down, since heads have smaller x than hips"},
      {[](const Vec3& p) { return Vec3(p / 0.0254); }, "Y is up"},
      {[](const Vec3& p) { return Vec3(p - Vec3(0, 1, 8)); }, "Y is up"}};
  for (const auto& [place, guess] : worlds) {
    std::string text = "t";
    for (int j = 0; j < kBodyJointCount; ++j) {
      for (const char axis : {'x', 'y', 'z'}) text += fmt::format(",{}_{}", nameOf(static_cast<J>(j)), axis);
    }
    for (const SkeletonFrame& frame : truth) {
      text += fmt::format("\n{}", frame.time);
      for (const TrackedJoint& joint : frame.joints) {
        const Vec3 p = place(joint.position);
        text += fmt::format(",{},{},{}", p.x(), p.y(), p.z());
      }
    }
    const JointStream stream = test::valueOf(parseJointStream(text + "\n", "walk.csv"));
    EXPECT_TRUE(stream.firstGuess.at(1).starts_with(guess)) << stream.firstGuess.at(1);
    const SkeletonFrame& read = stream.frames[25];
    const Vec3 moved = read[J::kTorso].position - truth[25][J::kTorso].position;
    for (int j = 0; j < kBodyJointCount; ++j) {
      EXPECT_LT((read.joints[j].position - truth[25].joints[j].position - moved).norm(), 1e-5) << guess << " " << j;
    }
  }
}

TEST(AzureJson, GivesThePerformance) {
  const std::vector<SkeletonFrame> truth = walk();
  const auto fileOf = [&](std::string_view names, std::string_view unit) {
    std::string text = fmt::format("{{{}\"frames\": [", names);
    for (const SkeletonFrame& frame : truth) {
      text += fmt::format("{}{{\"timestamp_usec\": {:.0f}, \"bodies\": [{{\"body_id\": 4, \"joint_positions\": [",
                          text.back() == '[' ? "" : ", ", 1e6 * (5.0 + frame.time));
      for (const J j : {J::kHead, J::kNeck, J::kTorso, J::kLeftShoulder, J::kRightShoulder, J::kLeftElbow,
                        J::kRightElbow, J::kLeftHand, J::kRightHand, J::kLeftHip, J::kRightHip, J::kLeftKnee,
                        J::kRightKnee, J::kLeftFoot, J::kRightFoot}) {
        const Vec3& p = frame[j].position;
        text += fmt::format("{}[{:.3f}, {:.3f}, {:.3f}]", text.back() == '[' ? "" : ", ", 1000 * p.x(),
                            1000 * (1 - p.y()), 1000 * (3 - p.z()));
      }
      text += fmt::format("], \"unit\": \"{}\"}}]}}", unit);
    }
    return text + "]}";
  };
  const std::string names =
      R"("joint_names": ["HEAD", "NECK", "SPINE_NAVEL", "SHOULDER_LEFT", "SHOULDER_RIGHT", "ELBOW_LEFT", "ELBOW_RIGHT",
      "HAND_LEFT", "HAND_RIGHT", "HIP_LEFT", "HIP_RIGHT", "KNEE_LEFT", "KNEE_RIGHT", "ANKLE_LEFT", "ANKLE_RIGHT"], )";
  const std::string text = fileOf(names, "mm");
  const JointStream stream = test::valueOf(parseJointStream(text, "walk.json"));
  EXPECT_EQ(stream.format, JointFormat::kAzureJson);
  EXPECT_EQ(stream.firstGuess.at(0), "millimetres, since the body measures 1740 (1.74 m)");
  ASSERT_EQ(stream.frames.size(), truth.size());
  for (std::size_t f = 0; f < truth.size(); ++f) {
    EXPECT_NEAR(stream.frames[f].time, truth[f].time, 2e-6);
    const Vec3 moved = stream.frames[0][J::kHead].position - truth[0][J::kHead].position;
    for (int j = 0; j < kBodyJointCount; ++j) {
      EXPECT_LT((stream.frames[f].joints[j].position - truth[f].joints[j].position - moved).norm(), 1e-5);
    }
  }
  const std::tuple<std::string, std::string_view> cases[] = {
      {fileOf("", "mm"), ": found no joint_names and 15 joints, expected 32"},
      {R"({"a": {"joint_positions": 1}})", ": found no list of frames, expected frames, each with bodies"},
      {R"({"frames": [{"bodies": []}], "joint_positions": 1})", ": found no body in 1 frame, expected at least one"},
      {R"({"frames": [{"bodies": [{"joint_positions": 1}]}]})",
       ", frame 0: found a body without joint_positions, expected a list of them"},
      {R"({"joint_names": ["HEAD"], "frames": [{"bodies": [{"joint_positions": [[1, 2]]}]}]})",
       ", frame 0, joint 1: found '[1,2]', expected a position of 3 numbers within +-40000"},
      {R"({"joint_names": ["HEAD"], "frames": [{"bodies": [{"joint_positions": [[1, 2, 3], [1, 2, 3]]}]}]})",
       ", frame 0: found 2 joint_positions, expected at most 1, as there are joint_names"}};
  for (const auto& [bad, sentence] : cases) {
    const Result<JointStream> refused = parseJointStream(bad, "x");
    EXPECT_EQ(refused ? "accepted" : refused.error().message, fmt::format("x{}", sentence));
  }
  for (std::size_t length = 0; length < text.size(); length += length < 400 ? 1 : 97) {
    EXPECT_FALSE(parseJointStream(std::string_view(text).substr(0, length), "x", {.format = JointFormat::kAzureJson}));
  }
}

TEST(JointColumns, DamagedFilesGiveASentenceOrSoundJoints) {
  const test::TemporaryFolder folder;
  std::vector<SkeletonFrame> truth = walk();
  truth.resize(4);
  std::string world = "timestamp,id", picture = "frame", rows = "time,landmark,x,y,z,visibility";
  for (int i = 0; i < countOf(kLandmarks); ++i) {
    world += fmt::format(",{0}_x,{0}_y,{0}_z,{0}_visibility", landmarkName(i));
    picture += fmt::format(",x{0},y{0},z{0}", i);
  }
  std::string json = R"({"frames": [)";
  for (int f = 0; f < countOf(truth); ++f) {
    world += fmt::format("\n2024-02-29T23:59:59.{}Z,{}", f, f % 2);
    picture += fmt::format("\n{}", f);
    json += fmt::format(R"({}{{"timestamp_usec": {}, "bodies": [{{"body_id": 1, "joint_positions": [)",
                        f == 0 ? "" : ",", f);
    for (int i = 0; i < countOf(kLandmarks); ++i) {
      const Vec3 p = landmarkOf(truth[f], i);
      world += fmt::format(",{:.3f},{:.3f},{:.3f},0.9", p.x(), p.y(), p.z());
      picture += fmt::format(",{:.3f},{:.3f},{:.3f}", 0.5 + 0.2 * p.x(), 0.5 + 0.3 * p.y(), 0.2 * p.z());
      rows += fmt::format("\n0:00:0{},{},{:.3f},{:.3f},{:.3f},0.9", f, i, p.x(), p.y(), p.z());
      json += fmt::format("{}[{:.0f},{:.0f},{:.0f}]", i == 0 ? "" : ",", 1e3 * p.x(), 1e3 * p.y(), 3e3 + 1e3 * p.z());
    }
    json += "]}]}";
  }
  json += "]}";
  std::mt19937 random(40);
  constexpr std::string_view kSigns = "0123456789.,;:- \t\n\re+xyzNav{}[]\"#";
  for (const std::string& text : {world + "\n", picture + "\n", rows + "\n", json}) {
    const JointStream whole = test::valueOf(parseJointStream(text, "x"));
    for (int round = 0; round < 250; ++round) {
      std::string damaged = text;
      for (unsigned hits = 1 + random() % 3; hits > 0; --hits) {
        const std::size_t at = random() % damaged.size();
        if (random() % 3 == 0) {
          damaged.erase(at, 1 + random() % 40);
        } else if (random() % 2 == 0) {
          damaged[at] = kSigns[random() % kSigns.size()];
        } else {
          damaged.insert(at, damaged.substr(random() % damaged.size(), random() % 40));
        }
      }
      const Result<JointStream> stream = parseJointStream(damaged, "x");
      if (!stream) {
        EXPECT_TRUE(stream.error().message.starts_with("x")) << stream.error().message;
        continue;
      }
      const Result<void> written = writeJointCsv(folder.path() / "out.csv", stream->frames);
      EXPECT_TRUE(written) << written.error().message;
    }
  }
}

}  // namespace
}  // namespace lorica
