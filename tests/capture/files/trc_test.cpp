#include "capture/files/joint_csv.h"
#include "capture/files/joint_stream.h"
#include "geometry/counts.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// OpenSim's tables of markers that are named as joints.
namespace lorica {
namespace {

using J = BodyJoint;

std::vector<SkeletonFrame> walk() {
  std::vector<SkeletonFrame> frames = shippedFrames("walk");
  frames.resize(50);
  return frames;
}

/// Names as Pose2Sim and OpenCap write them, and where they are.
const std::vector<std::pair<std::string, J>> kMarkers = {{"RAnkle", J::kRightFoot},
                                                         {"LAnkle", J::kLeftFoot},
                                                         {"RKnee", J::kRightKnee},
                                                         {"LKnee", J::kLeftKnee},
                                                         {"RHip", J::kRightHip},
                                                         {"LHip", J::kLeftHip},
                                                         {"Neck", J::kNeck},
                                                         {"C7", J::kNeck},
                                                         {"Head", J::kHead},
                                                         {"RShoulder", J::kRightShoulder},
                                                         {"LShoulder", J::kLeftShoulder},
                                                         {"RElbow", J::kRightElbow},
                                                         {"LElbow", J::kLeftElbow},
                                                         {"r.ASIS_study", J::kRightHip},
                                                         {"RWrist", J::kRightHand},
                                                         {"LWrist", J::kLeftHand},
                                                         {"RSmallToe", J::kRightFoot}};

struct Writer {
  std::string_view unit = "m";
  double perMetre = 1.0;
  char separator = '\t';
  std::string_view prefix = {};
  Vec3 from = Vec3::Zero();  ///< where the walk is [m]
  bool blankLine = false, gaps = false;
  double rate = 30.0;
};

std::string fileOf(const Writer& writer, const std::vector<SkeletonFrame>& frames,
                   const std::vector<std::pair<std::string, J>>& markers = kMarkers) {
  const char s = writer.separator;
  std::string text = fmt::format(
      "PathFileType{0}4{0}(X/Y/Z){0}walk.trc\n"
      "DataRate{0}CameraRate{0}NumFrames{0}NumMarkers{0}Units{0}OrigDataRate{0}OrigDataStartFrame{0}OrigNumFrames\n"
      "{1}{0}{1}{0}{2}{0}{3}{0}{4}{0}{1}{0}1{0}{2}\nFrame#{0}Time",
      s, writer.rate, frames.size(), markers.size(), writer.unit);
  std::string axes;
  for (int m = 0; m < countOf(markers); ++m) {
    text += fmt::format("{}{}{}{}", s, writer.prefix, markers[m].first, s == '\t' ? "\t\t" : "");
    axes += fmt::format("{0}X{1}{0}Y{1}{0}Z{1}", s, m + 1);
  }
  text += fmt::format("\n{}{}\n{}", s == '\t' ? "\t" : "", axes, writer.blankLine ? "\n" : "");
  for (int f = 0; f < countOf(frames); ++f) {
    text += fmt::format("{}{}{:.5f}", f + 1, s, f / writer.rate);
    for (int m = 0; m < countOf(markers); ++m) {
      // Of every fifth frame the last two markers are not seen.
      if (writer.gaps && f % 5 == 2 && m + 2 >= countOf(markers)) {
        text += "\t\t\t";
        continue;
      }
      const Vec3 p = writer.perMetre * (frames[f][markers[m].second].position + writer.from);
      text += fmt::format("{0}{1:.6f}{0}{2:.6f}{0}{3:.6f}", s, p.x(), p.y(), p.z());
    }
    text += '\n';
  }
  return text;
}

TEST(Trc, GivesThePerformance) {
  const std::vector<SkeletonFrame> truth = walk();
  const std::vector<Writer> writers = {
      {},
      {.unit = "mm", .perMetre = 1000.0, .blankLine = true, .rate = 120.0},
      {.unit = "Meters", .prefix = "Subject 1:", .from = Vec3(2.0, 0.5, 6.0), .gaps = true},
      {.unit = "", .perMetre = 100.0, .from = Vec3(0.0, 0.0, -6.0)},
      {.unit = "cm", .perMetre = 100.0, .separator = ' '}};
  for (const Writer& writer : writers) {
    const std::string text = fileOf(writer, truth);
    SCOPED_TRACE(text.substr(0, 300));
    for (const bool windows : {false, true}) {
      std::string written = text;
      for (std::size_t at = 0; windows && (at = written.find('\n', at)) != std::string::npos; at += 2)
        written.insert(at, "\r");
      const JointStream stream = test::valueOf(parseJointStream(written, "walk.trc"));
      EXPECT_EQ(stream.format, JointFormat::kTrc);
      EXPECT_EQ(stream.firstGuess.at(1), "Y is up");
      ASSERT_EQ(stream.frames.size(), truth.size());
      for (std::size_t f = 0; f < truth.size(); ++f) {
        const SkeletonFrame& read = stream.frames[f];
        EXPECT_NEAR(read.time, static_cast<double>(f) / writer.rate, 2e-5);
        const Vec3 moved = read[J::kHead].position - truth[f][J::kHead].position;
        EXPECT_LT((moved - (stream.frames[0][J::kHead].position - truth[0][J::kHead].position)).norm(), 1e-5);
        for (const auto& [name, joint] : kMarkers) {
          const bool gap = writer.gaps && f % 5 == 2 && joint == J::kLeftHand;
          EXPECT_EQ(read[joint].confidence, gap ? 0.0 : 1.0);
          if (gap) continue;
          EXPECT_LT((read[joint].position - truth[f][joint].position - moved).norm(), 1e-5) << f << name;
        }
      }
    }
  }
}

TEST(Trc, WhoeverIsNamedTwiceIsTheFirst) {
  const std::vector<SkeletonFrame> truth = walk();
  std::vector<std::pair<std::string, J>> markers = kMarkers;
  markers.emplace_back("midHip", J::kTorso);
  markers.emplace_back("Pelvis", J::kHead);
  markers.emplace_back("R_Knee", J::kHead);
  const JointStream stream = test::valueOf(parseJointStream(fileOf({}, truth, markers), "walk.trc"));
  const auto thigh = [](const SkeletonFrame& frame) {
    return Vec3(frame[J::kRightKnee].position - frame[J::kRightHip].position);
  };
  EXPECT_LT((thigh(stream.frames[9]) - thigh(truth[9])).norm(), 1e-5);
}

TEST(Trc, WhatNamesNoJointsIsRefusedWithASentence) {
  const std::vector<SkeletonFrame> truth = walk();
  std::vector<std::pair<std::string, J>> markers = {{"RASI", J::kRightHip}, {"LASI", J::kLeftHip}, {"C7", J::kNeck}};
  const auto refusal = [](const std::string& text) {
    const Result<JointStream> stream = parseJointStream(text, "walk.trc");
    return stream ? "accepted" : stream.error().message;
  };
  EXPECT_EQ(refusal(fileOf({}, truth, markers)),
            "walk.trc, line 5: found a header that names 0 joints, expected at least 6");
  const std::string text = fileOf({}, truth);
  EXPECT_EQ(refusal(text.substr(0, text.find("Frame#"))),
            "walk.trc: found no line of Frame#, Time and names in the first 20 lines, expected a table of markers");
  EXPECT_EQ(refusal(text.substr(0, text.find("\n1\t") + 1)),
            "walk.trc: found a header and no rows, expected at least one");
  std::string torn = text;
  torn.insert(torn.find('\n', torn.find("\n3\t") + 1), "\t7");
  EXPECT_EQ(refusal(torn), "walk.trc, line 8: found 54 fields, expected 53 as in the header");
  for (std::size_t length = 0; length < text.size(); length += length < 700 ? 1 : 211) {
    const Result<JointStream> stream = parseJointStream(std::string_view(text).substr(0, length), "x");
    EXPECT_TRUE(stream || stream.error().message.starts_with("x")) << length;
  }
}

}  // namespace
}  // namespace lorica
