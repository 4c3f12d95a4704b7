#include "capture/files/joint_csv.h"

#include "geometry/files.h"
#include "tests/capture/figures.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace lorica {
namespace {

using test::TemporaryFolder;

std::string header() {
  std::string line = "time,user";
  for (int j = 0; j < kBodyJointCount; ++j) {
    for (const char* field : {"x", "y", "z", "qx", "qy", "qz", "qw", "confidence"}) {
      line += ',';
      line += nameOf(static_cast<BodyJoint>(j));
      line += '.';
      line += field;
    }
  }
  return line;
}

/// A row whose field `column` (from 1) is `text`; the others are valid.
std::string row(const std::string& time, const std::string& user, int column = 0, const std::string& text = "") {
  std::string line;
  for (int c = 1; c <= 122; ++c) {
    if (c > 1) line += ',';
    const int field = (c - 3) % 8;
    std::string value = c == 1 ? time : c == 2 ? user : field < 3 ? "0.25" : field < 7 ? "" : "1";
    line += c == column ? text : value;
  }
  return line;
}

/// The error message for a file with this content, without the folder name.
std::string refusal(const std::string& content) {
  const TemporaryFolder folder;
  const auto frames = readJointCsv(folder.write("walk.csv", content));
  if (frames) return "accepted";
  EXPECT_EQ(frames.error().code, ErrorCode::kBadFormat);
  const std::string& message = frames.error().message;
  const std::size_t name = message.find("walk.csv");
  return name == std::string::npos ? message : message.substr(name);
}

TEST(JointCsv, MissingFileAndFolderAreRefused) {
  const TemporaryFolder folder;
  const auto missing = readJointCsv(folder.path() / "nowhere.csv");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_NE(missing.error().message.find("nowhere.csv"), std::string::npos);
  EXPECT_FALSE(readJointCsv(folder.path()));
}

/// A row with four fields in place of those of the head's quaternion.
std::string rowWith(const std::string& quaternion) {
  std::string line = row("1", "1", 6, quaternion);
  return line.erase(line.find(quaternion) + quaternion.size(), 3);  // the three empty fields after it
}

TEST(JointCsv, BadFilesAreRefusedWithLineAndColumn) {
  std::string wrong = header();
  wrong.replace(wrong.find("neck.y"), 6, "neck.Y");
  const std::string firstRow = header() + "\n" + row("0", "1") + "\n";
  const std::string kMust = "time must increase for user 1";
  const std::pair<std::string, std::string> files[] = {
      {"", ": found an empty file, expected a header line"},
      {"\xef\xbb\xbf\r\n", ": found an empty file, expected a header line"},
      {header() + "\r\n\r\n", ": found a header and no rows, expected at least one frame"},
      {wrong + "\n", ", line 1, column 12: found \"neck.Y\", expected \"neck.y\""},
      {header().substr(0, header().rfind(',')) + "\n",
       ", line 1: found 121 columns, expected 122; column 122, \"right_foot.confidence\", is missing"},
      {header() + ",extra\n", ", line 1, column 123: found \"extra\", expected the line to end after 122 columns"},
      {"time;user;head.x\n", ", line 1, column 1: found \"time;user;head.x\", expected \"time\""},
      {std::string("\x89PNG\r\n\0\1", 8), ", line 1, column 1: found \"\\x89PNG\", expected \"time\""},
      {std::string(1000, 'x'), ", line 1, column 1: found \"" + std::string(40, 'x') + "...\", expected \"time\""},
      {header() + "\n\n" + row("0", "1"), ", line 2: found an empty line, expected 122 fields"},
      {firstRow + "1,2,3\n", ", line 3: found 3 fields, expected 122 fields"},
      {firstRow + row("1", "1") + ",\n", ", line 3: found 123 fields, expected 122 fields"},
      {firstRow + row("0", "1") + "\n",
       ", line 3, column 1 (time): found \"0\", expected more than 0 (line 2): " + kMust},
      {header() + "\n" + row("5", "1") + "\n" + row("1", "2") + "\n" + row("4.5", "1"),
       ", line 4, column 1 (time): found \"4.5\", expected more than 5 (line 2): " + kMust}};
  for (const auto& [file, sentence] : files) EXPECT_EQ(refusal(file), "walk.csv" + sentence);

  const std::pair<std::string, std::string> rows[] = {
      {row("1", "1", 12, "abc"), "12 (neck.y): found \"abc\", expected a number"},
      {row("1", "1", 3, "nan"), "3 (head.x): found \"nan\", expected a number"},
      {row("1", "1", 5, "-inf"), "5 (head.z): found \"-inf\", expected a number"},
      {row("1", "1", 5, "1e999"), "5 (head.z): found \"1e999\", expected a number"},
      {row("1", "1", 115, ""), "115 (right_foot.x): found an empty field, expected a number"},
      {row("1", "1", 122, "1.0x"), "122 (right_foot.confidence): found \"1.0x\", expected a number"},
      {row("late", "1"), "1 (time): found \"late\", expected a number"},
      {row("1", "1.5"), "2 (user): found \"1.5\", expected a whole number"},
      {row("1", "1", 4, "1432.5"), "4 (head.y): found \"1432.5\", expected metres within +-100"},
      {row("1", "1", 10, "1.5"), "10 (head.confidence): found \"1.5\", expected a confidence from 0 to 1"},
      {row("1", "1", 10, "-0.5"), "10 (head.confidence): found \"-0.5\", expected a confidence from 0 to 1"},
      {row("1e15", "1"), "1 (time): found \"1e15\", expected seconds within +-1e12"},
      {row("1", "1", 9, "1"), "6 (head.qx): found an empty field, expected all four quaternion fields or none"},
      {rowWith("0,0,0,0"), "6 (head.qx): found a quaternion of length 0, expected length 1 +- 0.01"},
      {rowWith("0,0,0,0.97"), "6 (head.qx): found a quaternion of length 0.97, expected length 1 +- 0.01"},
      {rowWith("1e300,1e300,0,0"), "6 (head.qx): found a quaternion of length 1.414e+300, expected length 1 +- 0.01"},
      {rowWith("0,0,w,1"), "8 (head.qz): found \"w\", expected a number"}};
  for (const auto& [bad, sentence] : rows) {
    EXPECT_EQ(refusal(firstRow + bad + "\n"), "walk.csv, line 3, column " + sentence);
  }
}

TEST(JointCsv, QuaternionsThatAreNearlyUnitAreNormalised) {
  const TemporaryFolder folder;
  const auto near = test::valueOf(readJointCsv(folder.write("near.csv", header() + "\n" + rowWith("0,0,0,0.995"))));
  ASSERT_TRUE(near[0][BodyJoint::kHead].orientation);
  EXPECT_DOUBLE_EQ(near[0][BodyJoint::kHead].orientation->w(), 1.0);
  EXPECT_FALSE(near[0][BodyJoint::kNeck].orientation);
}

TEST(JointCsv, TheUserWithMostFramesIsKept) {
  const TemporaryFolder folder;
  const auto max = test::valueOf(readJointCsv(
      folder.write("two.csv", header() + "\n" + row("5", "7") + "\n" + row("1", "3") + "\n" + row("2", "3") + "\n")));
  ASSERT_EQ(max.size(), 2u);
  EXPECT_EQ(max.front().user, 3);
  const auto tie =
      test::valueOf(readJointCsv(folder.write("tie.csv", header() + "\n" + row("5", "7") + "\n" + row("1", "-3"))));
  EXPECT_EQ(tie.front().user, 7);
}

TEST(JointCsv, ByteOrderMarkCarriageReturnsAndBlankEndAreAccepted) {
  const TemporaryFolder folder;
  const auto frames = test::valueOf(readJointCsv(folder.write(
      "walk.csv", "\xef\xbb\xbf" + header() + "\r\n" + row("0", "1") + "\r\n" + row("0.5", "1") + "\r\n\r\n\n")));
  EXPECT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[1].time, 0.5);
  EXPECT_EQ(frames[1][BodyJoint::kRightFoot].position, Vec3::Constant(0.25));
}

std::vector<SkeletonFrame> awkwardFrames() {
  std::vector<SkeletonFrame> frames;
  for (std::uint32_t i = 0; i < 5; ++i) {
    frames.push_back(test::makeFrame(test::randomPose(i), 0.1 * i - 0.3, i % 2 == 0));
    frames.back().user = 4;
    frames.back()[BodyJoint::kLeftKnee].confidence = 0.1 * i;
  }
  frames[0][BodyJoint::kHead].position = Vec3(5e-324, -0.0, 0.1 + 0.2);
  frames[1][BodyJoint::kHead].position = Vec3(1.0 / 3.0, -99.99999999999999, 1e-17);
  return frames;
}

void expectSameBits(double a, double b) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b)) << a << " and " << b;
}

TEST(JointCsv, RoundTripKeepsEveryBit) {
  const TemporaryFolder folder;
  const std::vector<SkeletonFrame> frames = awkwardFrames();
  const std::filesystem::path file = folder.path() / "round.csv";
  const auto written = writeJointCsv(file, frames);
  ASSERT_TRUE(written) << written.error().message;
  const auto read = test::valueOf(readJointCsv(file));
  ASSERT_EQ(read.size(), frames.size());
  for (std::size_t f = 0; f < frames.size(); ++f) {
    expectSameBits(read[f].time, frames[f].time);
    EXPECT_EQ(read[f].user, 4);
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      const TrackedJoint& a = read[f].joints[j];
      const TrackedJoint& b = frames[f].joints[j];
      for (int axis = 0; axis < 3; ++axis) expectSameBits(a.position[axis], b.position[axis]);
      expectSameBits(a.confidence, b.confidence);
      ASSERT_EQ(a.orientation.has_value(), b.orientation.has_value());
      for (int i = 0; a.orientation && i < 4; ++i) {
        expectSameBits(a.orientation->coeffs()[i], b.orientation->coeffs()[i]);
      }
    }
  }
}

TEST(JointCsv, EveryPrefixAndEveryFlippedByteLoadsOrFailsWithASentence) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "whole.csv";
  const auto expectSound = [](std::string_view text, std::size_t at) {
    const auto frames = parseJointCsv(text, "cut.csv");
    if (!frames) {
      EXPECT_NE(frames.error().message.find("cut.csv"), std::string::npos) << at;
      EXPECT_NE(frames.error().message.find("expected"), std::string::npos) << at;
      return;
    }
    EXPECT_GE(frames->size(), 1U);
    for (const TrackedJoint& joint : frames->front().joints) {
      EXPECT_TRUE(joint.position.allFinite()) << at;
      EXPECT_NEAR(joint.orientation.value_or(Quat::Identity()).norm(), 1.0, 1e-9) << at;
    }
  };
  const std::vector<SkeletonFrame> written = awkwardFrames();
  for (const std::size_t count : {2, 1}) {
    ASSERT_TRUE(writeJointCsv(file, std::span(written).first(count)));
    const std::string whole = readFile(file).value();
    for (std::size_t at = 0; at < whole.size(); ++at) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
      expectSound(count == 2 ? whole.substr(0, at) : damaged, at);
    }
  }
}

TEST(JointCsv, WriterRefusesWhatTheReaderWould) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "bad.csv";
  const auto refused = [&](const std::vector<SkeletonFrame>& frames) {
    const auto result = writeJointCsv(file, frames);
    EXPECT_FALSE(std::filesystem::exists(file));
    if (result) return std::string("accepted");
    return result.error().message.substr(result.error().message.find("bad.csv"));
  };
  EXPECT_EQ(refused({}), "bad.csv: found no frames to write, expected at least one");
  using Frames = std::vector<SkeletonFrame>;
  const std::pair<void (*)(Frames&), std::string> cases[] = {
      {[](Frames& f) { f[1].time = f[0].time; },
       "frame 1, time: found -0.3, expected more than -0.3: time must increase for user 4"},
      {[](Frames& f) { f[2][BodyJoint::kNeck].position.y() = std::numeric_limits<double>::quiet_NaN(); },
       "frame 2, neck.y: found nan, expected metres within +-100"},
      {[](Frames& f) { f[3][BodyJoint::kTorso].confidence = 1.01; },
       "frame 3, torso.confidence: found 1.01, expected 0 to 1"},
      {[](Frames& f) { f[0][BodyJoint::kTorso].orientation = Quat(0.5, 0, 0, 0); },
       "frame 0, torso: found a quaternion of length 0.5, expected length 1 +- 0.01"}};
  for (const auto& [spoil, sentence] : cases) {
    Frames frames = awkwardFrames();
    spoil(frames);
    EXPECT_EQ(refused(frames), "bad.csv: " + sentence);
  }
}

TEST(JointCsv, TheExampleInTheFormatsDescriptionLoads) {
  const auto text = test::valueOf(readFile(test::recordingsFolder() / "FORMAT.md"));
  const std::size_t begin = text.find("```csv\n") + 7;
  const TemporaryFolder folder;
  const auto frames =
      test::valueOf(readJointCsv(folder.write("example.csv", text.substr(begin, text.find("```", begin) - begin))));
  ASSERT_EQ(frames.size(), 2u);
  const SkeletonFrame& lowered = frames[1];
  EXPECT_EQ(lowered[BodyJoint::kRightHand].confidence, 0.0);
  ASSERT_TRUE(lowered[BodyJoint::kLeftShoulder].orientation);
  const Vec3 upperArm = lowered[BodyJoint::kLeftElbow].position - lowered[BodyJoint::kLeftShoulder].position;
  const Vec3 said = *lowered[BodyJoint::kLeftShoulder].orientation * Vec3::UnitX();
  EXPECT_LT(test::angleBetween(upperArm, said), 1e-6);
}

TEST(RecordedSource, GivesTheFramesThenNothing) {
  const auto source = makeRecordedSource(awkwardFrames());
  for (int i = 0; i < 5; ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame && *frame);
    EXPECT_EQ((*frame)->time, 0.1 * i - 0.3);
  }
  for (int i = 0; i < 2; ++i) {
    const auto end = test::valueOf(source->next());
    EXPECT_FALSE(end);
  }
}

TEST(BodyJoint, NamesAreDistinct) {
  EXPECT_EQ(nameOf(BodyJoint::kHead), "head");
  EXPECT_EQ(nameOf(BodyJoint::kRightFoot), "right_foot");
  for (int a = 0; a < kBodyJointCount; ++a) {
    for (int b = 0; b < a; ++b) EXPECT_NE(nameOf(static_cast<BodyJoint>(a)), nameOf(static_cast<BodyJoint>(b)));
  }
}

}  // namespace
}  // namespace lorica
