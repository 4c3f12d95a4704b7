#include "capture/files/joint_csv.h"
#include "capture/files/joint_stream.h"
#include "tests/capture/files/joint_files.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

namespace lorica {
namespace {

using test::BodiesRow;
using test::TemporaryFolder;

// Files that do not contain joints, truncated files, damaged files.

std::vector<SkeletonFrame> fewFrames(std::size_t count) {
  std::vector<SkeletonFrame> frames = shippedFrames("wave");
  frames.resize(count);
  return frames;
}

std::string refusal(const std::string& text, const JointStreamSettings& settings = {}) {
  const auto stream = parseJointStream(text, "walk.txt", settings);
  return stream ? "accepted" : stream.error().message;
}

/// Requirement for every accepted stream: it can be written in Lorica's own format.
void expectSound(const JointStream& stream, const std::filesystem::path& scratch) {
  const Result<void> written = writeJointCsv(scratch, stream.frames);
  EXPECT_TRUE(written) << written.error().message;
}

TEST(JointStreamBad, WhatIsNoneOfThemIsNamed) {
  EXPECT_EQ(refusal(""), "walk.txt: found an empty file, expected recorded joints");
  EXPECT_EQ(refusal("\xef\xbb\xbf\r\n \r\n"), "walk.txt: found an empty file, expected recorded joints");
  const char* none = ", expected recorded joints in a layout that Lorica knows, or in one that --format names";
  EXPECT_EQ(refusal("HIERARCHY\nROOT Hips\n"),
            std::string("walk.txt: found a text that begins with 'HIERARCHY'") + none);
  EXPECT_EQ(refusal(std::string("\x89PNG\r\n\0\1", 8)),
            std::string("walk.txt: found data that begins with '\\x89PNG'") + none);
  const TemporaryFolder folder;
  EXPECT_EQ(readJointStream(folder.path() / "nowhere.txt").error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(readJointStream(folder.path()));
}

/// What once took a second a row, and an hour a name. These end; a test that looked at clocks would prove less.
TEST(JointStreamBad, RowsAndNamesThatAreMadeToBeSlowEnd) {
  std::string header = "Time", row;
  for (const char* joint : {"SpineBase", "SpineMid", "Neck", "Head", "ShoulderLeft", "ElbowLeft", "WristLeft",
                            "HandLeft", "ShoulderRight", "ElbowRight", "WristRight", "HandRight", "HipLeft"}) {
    header += ",Joint,Status,PositionX,PositionY,PositionZ,RotationW,RotationX,RotationY,RotationZ";
    row += fmt::format(",{},2", joint);
    for (int n = 0; n < 9; ++n) header += ",RotationW";
    for (int n = 0; n < 24; ++n) row += ",2";
  }
  std::string text = header + '\n';
  for (int f = 0; f < 1000; ++f) text += std::to_string(f * 333333L) + row + '\n';
  (void)parseJointStream(text, "slow.csv");

  std::string longName;
  for (int i = 0; i < 400'000; ++i) longName += "world";
  for (const std::string& name : {longName + "head_x", "head" + longName + "_x"}) {
    const auto stream = parseJointStream("timestamp," + name + ",head_y,head_z\n1,1,1,1\n", "slow.csv");
    ASSERT_FALSE(stream);
    EXPECT_LT(stream.error().message.size(), 2000u);
  }
}

TEST(JointStreamBad, WhatMayBeTwoOfThemAsksForAName) {
  // 122 integers separated by commas: 15 joints of NiTE with orientations, or 61 numbers with decimal commas.
  std::string rows;
  for (int f = 0; f < 3; ++f) {
    rows += fmt::format("{},0", 2 * f);
    for (int j = 0; j < 15; ++j) rows += ",5,7,9,1,0,0,0,1";
    rows += '\n';
  }
  EXPECT_EQ(
      refusal(rows),
      "walk.txt: found rows that match utkinect and nite2, expected a single match; specify the layout with --format");
  EXPECT_EQ(refusal(rows, {.format = JointFormat::kNite2}), "accepted");
  EXPECT_EQ(refusal(rows, {.format = JointFormat::kUtKinect}), "accepted");
}

TEST(JointStreamBad, SentencesNameThePosition) {
  const std::vector<SkeletonFrame> frames = fewFrames(4);
  const auto replaced = [](std::string text, std::string_view what, std::string_view by) {
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos);
    return text.replace(at, what.size(), by);
  };
  const std::string wide = test::wideFile(frames);
  EXPECT_EQ(refusal(replaced(wide, "Head,TRACKED", "Tail,TRACKED")),
            "walk.txt, line 2, column 35 (Joint): found 'Tail', expected the name of a Kinect joint");
  EXPECT_EQ(refusal(replaced(wide, "Head,TRACKED", "Head,LOST")),
            "walk.txt, line 2, column 36 (Status): found 'LOST', expected TRACKED, INFERRED or NOTTRACKED");
  EXPECT_EQ(
      refusal(replaced(wide, "Time,", "When,")),
      "walk.txt: found a text that begins with 'EventIndex', expected recorded joints in a layout that Lorica knows, "
      "or in one that --format names");
  EXPECT_EQ(refusal(replaced(wide, "Time,", "When,"), {.format = JointFormat::kKinect2Wide}),
            "walk.txt, line 1: found a header without a Time column, expected one");
  const std::string plain = test::plainFile(frames);
  const std::string first = plain.substr(0, plain.find(';'));
  EXPECT_EQ(refusal(replaced(plain, first, "x"), {.format = JointFormat::kKinect2Plain}),
            "walk.txt, line 1, column 1 (joint 1 x): found 'x', expected a number");
  EXPECT_EQ(refusal(replaced(plain, first, "1432.5")),
            "walk.txt, line 1, column 1 (joint 1 x): found '1432.5', expected a position within +-40");
  EXPECT_EQ(refusal(plain + "1;2;3\n"), "walk.txt, line 5: found 3 fields, expected 75: 25 x (x y z)");
  EXPECT_EQ(refusal(test::longFile(frames) + "99,Snout,0,0,1\n"),
            "walk.txt, line 82, column 2 (JointType): found 'Snout', expected the name of a Kinect joint");
  EXPECT_EQ(refusal("1|kb,5,6,25,0,0,0,2,0,0\n"),
            "walk.txt, line 1, column 8 (body 4): found '2', expected 0 (absent) or 1");
  EXPECT_EQ(refusal("1|kb,5,6,25,0,0,0,0,0,0\n"), "walk.txt: found no body, expected at least one");
  EXPECT_EQ(refusal("1|kb,5,6,20,0,0,0,0,0,0\n"),
            "walk.txt, line 1, column 4 (joints): found '20', expected 25 joints per body");
  EXPECT_EQ(refusal(test::niteFile(frames, false, 1.0), {.format = JointFormat::kUtKinect}),
            "walk.txt, line 1: found 62 fields, expected 61: the frame number and 20 x (x y z)");
  EXPECT_EQ(
      refusal("0 1 2 3\n", {.format = JointFormat::kUiPrmd}),
      "walk.txt: UI-PRMD needs a second file with angles: found text only, expected a positions file with its angles "
      "file beside it");
}

TEST(JointStreamBad, AFileThatIsCutOffKeepsWhatIsWhole) {
  const TemporaryFolder folder;
  const std::vector<SkeletonFrame> frames = fewFrames(3);
  for (const test::JointFile& file : test::oneOfEach(frames)) {
    if (file.format == JointFormat::kLorica) continue;
    SCOPED_TRACE(nameOf(file.format));
    // Testing every length would take too long: all near the start and the end, some between.
    for (std::size_t length = 0; length < file.text.size();
         length += length < 100 || length + 100 > file.text.size() ? 1 : 23) {
      const auto stream =
          parseJointStream(std::string_view(file.text).substr(0, length), "cut.txt", {.format = file.format});
      if (stream) {
        EXPECT_LE(stream->frames.size(), frames.size());
        if (length % 5 == 0) expectSound(*stream, folder.path() / "out.csv");
      } else {
        EXPECT_TRUE(stream.error().message.starts_with("cut.txt")) << stream.error().message;
        EXPECT_NE(stream.error().message.find("expected"), std::string::npos) << stream.error().message;
      }
    }
  }
  std::string text = test::msrFile(frames);
  text.resize(text.rfind('\n', text.size() - 2) + 5);
  const auto stream = test::valueOf(parseJointStream(text, "cut.txt"));
  EXPECT_EQ(stream.frames.size(), 2u);
  EXPECT_EQ(stream.notes.at(1), "The last frame, line 60, is truncated and was omitted.");
}

TEST(JointStreamBad, DamagedBytesGiveASentenceOrSoundJoints) {
  const TemporaryFolder folder;
  const std::vector<SkeletonFrame> frames = fewFrames(2);
  std::vector<test::JointFile> files = test::oneOfEach(frames);
  files.push_back({JointFormat::kKinect2Wide, test::wideFile(frames, {.decimalCommas = true})});
  files.push_back({JointFormat::kKinect1Long, test::longFile(frames, 0, true)});
  std::mt19937 random(17);
  constexpr std::string_view kSigns = "0123456789.,;- \t\n\reE+naN|\"#";
  for (const test::JointFile& file : files) {
    SCOPED_TRACE(nameOf(file.format));
    for (int round = 0; round < 120; ++round) {
      std::string damaged = file.text;
      for (unsigned hits = 1 + random() % 3; hits > 0; --hits) {
        const std::size_t at = random() % damaged.size();
        switch (random() % 4) {
          case 0:
            damaged[at] = kSigns[random() % kSigns.size()];
            break;
          case 1:
            damaged[at] = static_cast<char>(random());
            break;
          case 2:
            damaged.erase(at, 1 + random() % 40);
            break;
          default: {
            const std::size_t from = random() % damaged.size();
            damaged.insert(at, damaged.substr(from, random() % 40));
          }
        }
        if (damaged.empty()) damaged += '0';
      }
      const bool forced = round % 2 == 0;
      const auto stream =
          parseJointStream(damaged, "bad.txt", {.format = forced ? std::optional(file.format) : std::nullopt});
      if (stream) {
        expectSound(*stream, folder.path() / "out.csv");
      } else {
        EXPECT_NE(stream.error().message.find("expected"), std::string::npos) << stream.error().message;
      }
    }
  }
}

TEST(JointStreamBad, TimesBeyondAllRecordingsAreRefused) {
  const std::vector<SkeletonFrame> frames = fewFrames(3);
  std::vector<SkeletonFrame> late = frames;
  late[2].time = 1e13;
  EXPECT_EQ(refusal(test::niteFile(late, false, 1.0)), "walk.txt: found times above 1e+13 s, expected at most 1e+09 s");
  late[2].time = std::nan("");
  EXPECT_EQ(refusal(test::niteFile(late, false, 1.0), {.format = JointFormat::kNite2}),
            "walk.txt, line 3, column 1 (time): found 'nan', expected a number");
}

TEST(JointStreamBad, UiPrmdSaysWhichFileIsMissing) {
  const TemporaryFolder folder;
  std::string row = "0";
  for (int i = 1; i < 66; ++i) row += i % 3 == 1 ? ",10" : ",0";
  row += "\n";
  const auto positions = folder.write("m01_positions.txt", row + row);
  const auto missing = readJointStream(positions);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_NE(missing.error().message.find("m01_angles.txt"), std::string::npos) << missing.error().message;
  const auto unnamed = readJointStream(folder.write("m01.txt", row));
  ASSERT_FALSE(unnamed);
  EXPECT_NE(unnamed.error().message.find("found neither \"positions\" nor \"angles\" in the file name"),
            std::string::npos);
  // One row of angles for two rows of positions.
  const auto angles = folder.write("m01_angles.txt", row);
  for (const auto& file : {positions, angles}) {
    const auto stream = test::valueOf(readJointStream(file));
    EXPECT_EQ(stream.frames.size(), 1u);
  }
}

constexpr std::size_t kComes = 30, kLeaves = 60, kEnd = 90;  // frames of the second person, and of the first

/// The first of two waves all the time, 0.6 m to the left of the middle; the second is there for a second, 0.6 m to the
/// right.
struct TwoPeople {
  std::vector<SkeletonFrame> first = at(-0.6, "wave");
  std::vector<SkeletonFrame> second = at(0.6, "jumping_jacks");

  static std::vector<SkeletonFrame> at(double x, std::string_view motion) {
    std::vector<SkeletonFrame> frames = shippedFrames(motion);
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
