#include "capture/files/joint_stream.h"

#include "capture/files/joint_csv.h"
#include "geometry/files.h"
#include "tests/capture/files/joint_files.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

using J = BodyJoint;
using test::BodiesRow;
using test::TemporaryFolder;

/// The first frames of a shipped motion.
std::vector<SkeletonFrame> performance(std::string_view motion, std::size_t count) {
  std::vector<SkeletonFrame> frames = shippedFrames(motion);
  frames.resize(std::min(count, frames.size()));
  return frames;
}

bool isArm(std::size_t joint) {
  return joint >= static_cast<std::size_t>(J::kLeftShoulder) && joint <= static_cast<std::size_t>(J::kRightHand);
}

/// Joints have the ground truth's positions relative to each other and to the axes; only the origin may differ.
void expectSameShape(const std::vector<SkeletonFrame>& read, const std::vector<SkeletonFrame>& truth, double tolerance,
                     bool armsOnly = false) {
  ASSERT_EQ(read.size(), truth.size());
  const Vec3 moved = read[0][J::kLeftShoulder].position - truth[0][J::kLeftShoulder].position;
  for (std::size_t f = 0; f < read.size(); ++f) {
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      if (armsOnly && !isArm(j)) continue;
      const TrackedJoint& joint = read[f].joints[j];
      ASSERT_GT(joint.confidence, 0.0) << f << " " << nameOf(static_cast<J>(j));
      ASSERT_LT((joint.position - truth[f].joints[j].position - moved).norm(), tolerance)
          << f << " " << nameOf(static_cast<J>(j));
    }
  }
}

JointStream parsed(const std::string& text, const JointStreamSettings& settings = {}) {
  Result<JointStream> stream = parseJointStream(text, "walk.txt", settings);
  EXPECT_TRUE(stream) << (stream ? "" : stream.error().message);
  return stream ? *stream : JointStream{};
}

bool hasNote(const JointStream& stream, std::string_view part) {
  return std::any_of(stream.notes.begin(), stream.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

TEST(JointStream, EveryLayoutIsToldByItsContentAndGivesThePerformance) {
  const std::vector<SkeletonFrame> truth = performance("walk", 60);
  for (const test::JointFile& file : test::oneOfEach(truth)) {
    SCOPED_TRACE(nameOf(file.format));
    const JointStream stream = parsed(file.text);
    EXPECT_EQ(stream.format, file.format);
    EXPECT_EQ(stream.people, std::vector<int>{1});
    expectSameShape(stream.frames, truth, 5e-6, file.format == JointFormat::kUpperBody);
    ASSERT_EQ(stream.frames.size(), truth.size());
    const double step = file.format == JointFormat::kMsrAction3d ? 1.0 / 15.0 : 1.0 / 30.0;
    // Times in the file are whole milliseconds.
    EXPECT_NEAR(stream.frames.back().time - stream.frames.front().time, 59.0 * step, 6e-4);
    if (file.format == JointFormat::kLorica || file.format == JointFormat::kUpperBody) continue;
    EXPECT_EQ(stream.frames.front().time, 0.0);
    // The floor: the true ankles are 0.085 to 0.09 m high, 0.08 is assumed.
    EXPECT_NEAR(stream.frames[0][J::kLeftFoot].position.y(), truth[0][J::kLeftFoot].position.y(), 0.012);
  }
}

TEST(JointStream, NoLayoutIsTakenForAnother) {
  const std::vector<SkeletonFrame> truth = performance("punch_and_kick", 40);
  std::vector<test::JointFile> files = test::oneOfEach(truth);
  files.push_back({JointFormat::kNite2, test::niteFile(truth, false, 1000.0)});
  files.push_back({JointFormat::kKinect2Wide, test::wideFile(truth, {.decimalCommas = true})});
  files.push_back({JointFormat::kKinect2Plain, test::plainFile(truth, true)});
  files.push_back({JointFormat::kKinect1Long, test::longFile(truth, 7, true)});
  for (const test::JointFile& file : files) {
    for (int i = 0; i < kJointFormatCount; ++i) {
      const auto format = static_cast<JointFormat>(i);
      SCOPED_TRACE(fmt::format("{} as {}", nameOf(file.format), nameOf(format)));
      const auto stream = parseJointStream(file.text, "f", {.format = format});
      // Lorica's own header names the joint of every column.
      const bool named = file.format == JointFormat::kLorica && format == JointFormat::kNamedColumns;
      EXPECT_EQ(stream.ok(), format == file.format || named);
      if (!stream) {
        EXPECT_NE(stream.error().message.find("found"), std::string::npos) << stream.error().message;
        EXPECT_NE(stream.error().message.find("expected"), std::string::npos) << stream.error().message;
      }
    }
    const auto told = test::valueOf(parseJointStream(file.text, "f"));
    EXPECT_EQ(told.format, file.format);
  }
}

TEST(JointStream, LineEndsByteOrderMarksAndBlankLinesChangeNothing) {
  const std::vector<SkeletonFrame> truth = performance("wave", 25);
  for (const test::JointFile& file : test::oneOfEach(truth)) {
    if (file.format == JointFormat::kLorica) continue;  // FORMAT.md does not allow blank lines between rows
    SCOPED_TRACE(nameOf(file.format));
    const JointStream plain = parsed(file.text);
    const JointStream dressed = parsed(test::inWindowsDress(file.text));
    ASSERT_EQ(plain.frames.size(), dressed.frames.size());
    for (std::size_t f = 0; f < plain.frames.size(); ++f) {
      EXPECT_EQ(plain.frames[f].time, dressed.frames[f].time);
      for (std::size_t j = 0; j < kBodyJointCount; ++j) {
        EXPECT_EQ(plain.frames[f].joints[j].position, dressed.frames[f].joints[j].position);
      }
    }
  }
}

TEST(JointStream, OtherDelimitersAndDecimalCommas) {
  const std::vector<SkeletonFrame> truth = performance("wave", 25);
  const auto with = [](std::string text, char from, char to) {
    std::replace(text.begin(), text.end(), from, to);
    return text;
  };
  const std::string nite = test::niteFile(truth, true, 1000.0);
  const std::string msr = test::msrFile(truth);
  const std::string plain = test::plainFile(truth);
  const std::string wide = test::wideFile(truth);
  for (const std::string& text :
       {with(nite, ',', ';'), with(nite, ',', '\t'), with(msr, '.', ','), with(msr, ' ', '\t'), with(msr, ' ', ';'),
        with(with(msr, '.', ','), ' ', ';'), with(plain, ';', ','), with(plain, ';', ' '), with(plain, ';', '\t'),
        with(plain, '.', ','), with(with(plain, '.', ','), ';', ' '), with(wide, ',', ';'), with(wide, ',', '\t'),
        with(with(wide, ',', ';'), '.', ',')}) {
    SCOPED_TRACE(text.substr(0, 60));
    expectSameShape(parsed(text).frames, truth, 5e-6);
  }
  // Commas as delimiters and also as decimal separators.
  for (const std::string& text : {test::upperBodyFile(truth), with(msr, ' ', ',')}) {
    SCOPED_TRACE(text.substr(0, 60));
    const JointStream stream = parsed(with(text, '.', ','));
    expectSameShape(stream.frames, truth, 5e-6, stream.format == JointFormat::kUpperBody);
  }
  // A delimiter at the end of each row.
  std::string ended;
  for (const char c : plain) ended += c == '\n' ? std::string(";\n") : std::string(1, c);
  expectSameShape(parsed(ended).frames, truth, 5e-6);
}

TEST(JointStream, UtKinectNumbersJumpAndRepeat) {
  const std::vector<SkeletonFrame> truth = performance("walk", 8);
  const std::vector<int> numbers = {190, 190, 194, 196, 200, 406, 406, 408};
  const JointStream stream = parsed(test::utKinectFile(truth, numbers));
  expectSameShape(stream.frames, truth, 5e-6);
  const std::vector<double> sixtieths = {0, 2, 4, 6, 10, 216, 217, 218};
  for (std::size_t f = 0; f < truth.size(); ++f) EXPECT_NEAR(stream.frames[f].time, sixtieths[f] / 60.0, 1e-9) << f;
  EXPECT_TRUE(hasNote(stream, "2 rows repeat a time with different data"));
  EXPECT_TRUE(hasNote(stream, "60 per second"));
  // With an odd number among them, numbers count the skeleton's own frames.
  const std::vector<int> odd = {1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_NEAR(parsed(test::utKinectFile(truth, odd)).frames[7].time, 7.0 / 30.0, 1e-9);
}

TEST(JointStream, UtKinectRowsOfASecondPersonAreDistinguished) {
  // As in subject 3 of the data set: for several frames another person is in the image under the same numbers.
  const std::vector<SkeletonFrame> truth = performance("walk", 40);
  std::vector<SkeletonFrame> other = performance("wave", 40);
  std::vector<SkeletonFrame> rows;
  std::vector<int> numbers;
  for (int f = 0; f < 40; ++f) {
    rows.push_back(truth[f]);
    numbers.push_back(2 * f);
    if (f < 10 || f >= 20) continue;
    for (TrackedJoint& joint : other[f].joints) joint.position += Vec3(1.6, 0, -0.5);
    rows.push_back(other[f]);
    numbers.push_back(2 * f);
  }
  const std::string text = test::utKinectFile(rows, numbers);
  const JointStream stream = parsed(text);
  EXPECT_EQ(stream.people, (std::vector<int>{1, 2}));
  expectSameShape(stream.frames, truth, 5e-6);
  EXPECT_EQ(parsed(text, {.person = 2}).frames.size(), 10u);
}

/// Two of six bodies: in slot 1 the walker, in slot 4 a person who stands still; the walker comes later.
std::string twoBodies(const std::vector<SkeletonFrame>& walker, const SkeletonFrame& still, int stateOfHands = 2) {
  std::vector<BodiesRow> rows;
  std::int64_t ticks = 43271723768560000;
  for (std::size_t f = 0; f < walker.size(); ++f) {
    BodiesRow row{.ticks = ticks};
    row.bodies[4] = &still;
    if (f >= 5) row.bodies[1] = &walker[f];
    row.stateOfHands = stateOfHands;
    rows.push_back(row);
    ticks += f % 3 == 0 ? 160000 : f % 3 == 1 ? 510000 : 330000;
  }
  return test::bodiesFile(rows);
}

TEST(JointStream, OfSixBodiesTheOneThatMovesIsTaken) {
  const std::vector<SkeletonFrame> truth = performance("walk", 120);
  SkeletonFrame still = truth[0];
  for (TrackedJoint& joint : still.joints) joint.position += Vec3(1.0, 0, 0);
  const std::string text = twoBodies(truth, still);
  const JointStream stream = parsed(text);
  EXPECT_EQ(stream.people, (std::vector<int>{1, 2}));
  expectSameShape(stream.frames, {truth.begin() + 5, truth.end()}, 5e-6);
  EXPECT_EQ(stream.frames[0].user, 2);
  // Steps of 51, 33 and 16 ms, as written.
  EXPECT_NEAR(stream.frames[1].time, 0.033, 1e-6);
  EXPECT_NEAR(stream.frames[2].time, 0.033 + 0.016, 1e-6);
  EXPECT_NEAR(stream.frames[3].time, 0.033 + 0.016 + 0.051, 1e-6);
  EXPECT_EQ(parsed(text, {.person = 1}).frames.size(), 120u);

  const auto nobody = parseJointStream(text, "two.txt", {.person = 7});
  ASSERT_FALSE(nobody);
  EXPECT_EQ(nobody.error().message, "two.txt: found no person 7, expected one of 1, 2");
}

TEST(JointStream, StatesAreConfidence) {
  const std::vector<SkeletonFrame> truth = performance("walk", 12);
  const JointStream inferred = parsed(twoBodies(truth, truth[0], 1));
  EXPECT_EQ(inferred.frames[0][J::kLeftHand].confidence, 0.5);
  EXPECT_EQ(inferred.frames[0][J::kLeftElbow].confidence, 1.0);
  const JointStream none = parsed(twoBodies(truth, truth[0], 0));
  EXPECT_EQ(none.frames[0][J::kLeftHand].confidence, 0.0);
  EXPECT_EQ(none.frames[0][J::kLeftHand].position, Vec3::Zero());
  EXPECT_EQ(parsed(test::wideFile(truth)).frames[0][J::kLeftHand].confidence, 0.5);
}

TEST(JointStream, BodiesWithAClockThatStandsStillAreTimedByTheLog) {
  const std::vector<SkeletonFrame> truth = performance("walk", 10);
  std::vector<BodiesRow> rows;
  for (std::size_t f = 0; f < 10; ++f) {
    BodiesRow row{.ticks = static_cast<std::int64_t>(f) * 400000};
    row.bodies[0] = &truth[f];
    rows.push_back(row);
  }
  std::string text = test::bodiesFile(rows);
  for (std::size_t at = text.find("|kb,"); at != std::string::npos; at = text.find("|kb,", at + 4)) {
    text.replace(at + 4, text.find(',', at + 4) - at - 4, "43271723768560000");
  }
  const JointStream stream = parsed(text);
  ASSERT_EQ(stream.frames.size(), 10u);
  EXPECT_NEAR(stream.frames[9].time, 0.36, 1e-9);
}

TEST(JointStream, BodiesWithAClockInOtherUnitsAreTimedByTheLog) {
  const std::vector<SkeletonFrame> truth = performance("walk", 10);
  std::string logged, unlogged;
  for (std::size_t f = 0; f < 10; ++f) {
    BodiesRow row{.ticks = static_cast<std::int64_t>(f) * 400000};
    row.bodies[0] = &truth[f];
    const std::string text = test::bodiesFile(std::vector{row});
    const std::size_t tick = text.find("|kb,") + 4;
    const std::string rest =
        std::to_string(40'000'000'000 * f) + text.substr(text.find(',', tick));  // ten thousandfold
    logged += text.substr(0, tick) + rest;
    unlogged += "x|kb," + rest;
  }
  const JointStream stream = parsed(logged);
  ASSERT_EQ(stream.frames.size(), 10u);
  EXPECT_NEAR(stream.frames[9].time, 0.36, 1e-9);
  EXPECT_TRUE(hasNote(stream, "the seconds before |kb were used"));
  // Without another clock the best that can be done is to guess the unit from the steps.
  EXPECT_TRUE(hasNote(parsed(unlogged), "Times are assumed to be in"));
}

TEST(JointStream, BodiesThatAreAbsentMayBeLeftOutAtTheEndOfARow) {
  const std::vector<SkeletonFrame> truth = performance("walk", 10);
  std::vector<BodiesRow> rows;
  for (std::size_t f = 0; f < 10; ++f) {
    BodiesRow row{.ticks = static_cast<std::int64_t>(f) * 333333};
    row.bodies[1] = &truth[f];
    rows.push_back(row);
  }
  const std::string whole = test::bodiesFile(rows);
  for (const char* end : {"\n", ",\n"}) {
    std::string text = whole;
    for (std::size_t at = text.find(",0,0,0,0\n"); at != std::string::npos; at = text.find(",0,0,0,0\n", at)) {
      text.replace(at, 9, end);
    }
    ASSERT_LT(text.size(), whole.size());
    const JointStream stream = parsed(text);
    const JointStream expected = parsed(whole);
    ASSERT_EQ(stream.frames.size(), expected.frames.size());
    for (std::size_t f = 0; f < stream.frames.size(); ++f) {
      EXPECT_EQ(stream.frames[f].time, expected.frames[f].time);
      EXPECT_EQ(stream.frames[f][J::kLeftHand].position, expected.frames[f][J::kLeftHand].position);
    }
  }
}

TEST(JointStream, WideRowsTornByDecimalCommasHave379Fields) {
  const std::vector<SkeletonFrame> truth = performance("punch_and_kick", 80);
  const std::string text = test::wideFile(truth, {.decimalCommas = true});
  const std::string header = text.substr(0, text.find('\n'));
  const std::string row = text.substr(header.size() + 1, text.find('\n', header.size() + 1) - header.size() - 1);
  EXPECT_EQ(std::count(header.begin(), header.end(), ',') + 1, 232);
  EXPECT_EQ(std::count(row.begin(), row.end(), ',') + 1, 379);
  const JointStream stream = parsed(text);
  expectSameShape(stream.frames, truth, 5e-6);
  EXPECT_TRUE(hasNote(stream, "split at decimal commas"));
}

TEST(JointStream, WideColumnsAreFoundByName) {
  const std::vector<SkeletonFrame> truth = performance("punch_and_kick", 20);
  expectSameShape(parsed(test::wideFile(truth, {.shuffled = true})).frames, truth, 5e-6);
  expectSameShape(parsed(test::wideFile(truth, {.decimalCommas = true, .delimiter = ';'})).frames, truth, 5e-6);
  // Another program puts the joint name into the column name.
  std::string text = "EventIndex,Time,SkeletonId";
  for (const std::string_view name : test::kinect2Names()) {
    text += fmt::format(",{0}PositionX,{0}PositionY,{0}PositionZ,{0}RotationW", name);
  }
  for (std::size_t f = 0; f < truth.size(); ++f) {
    text += fmt::format("\n{},{},5", f, f * 333333);
    for (const Vec3& p : test::kinectBodyOf(truth[f]))
      text += fmt::format(",{:.7f},{:.7f},{:.7f},1", p.x(), p.y(), p.z());
  }
  expectSameShape(parsed(text + '\n').frames, truth, 5e-6);
}

TEST(JointStream, LongRowsAreGroupedByTime) {
  std::vector<SkeletonFrame> truth;
  const std::vector<SkeletonFrame> all = performance("walk", 300);
  for (std::size_t f = 0; f < all.size(); f += 10) truth.push_back(all[f]);  // 3 per second
  const JointStream whole = parsed(test::longFile(truth));
  expectSameShape(whole.frames, truth, 5e-6);
  EXPECT_NEAR(whole.frames[1].time, 0.333, 1e-9);

  const JointStream holes = parsed(test::longFile(truth, 7));
  ASSERT_EQ(holes.frames.size(), truth.size());
  EXPECT_TRUE(hasNote(holes, "30 frames have fewer than 20 joints"));
  // Row 7 of the first group is the left wrist, which is not used if the hand is there; row 14 is the left knee.
  EXPECT_EQ(holes.frames[0][J::kLeftKnee].confidence, 0.0);
  EXPECT_EQ(holes.frames[0][J::kRightKnee].confidence, 1.0);

  expectSameShape(parsed(test::longFile(truth, 0, true)).frames, truth, 5e-6);
}

TEST(JointStream, ZerosAndNanAreGaps) {
  const std::vector<SkeletonFrame> truth = performance("wave", 10);
  std::string text = test::plainFile(truth);
  std::string zeros = "0;0;0";
  std::string nans = "NaN;nan;";
  for (int i = 1; i < 25; ++i) zeros += ";0.0;0;-0.000";
  for (int i = 1; i < 25; ++i) nans += i % 2 == 0 ? ";NaN;1.5;-nan(ind)" : ";-1.#IND;1.#QNAN;0.3";
  const JointStream stream = parsed(zeros + '\n' + text + nans + '\n');
  ASSERT_EQ(stream.frames.size(), 12u);
  for (const std::size_t f : {std::size_t{0}, std::size_t{11}}) {
    for (const TrackedJoint& joint : stream.frames[f].joints) {
      EXPECT_EQ(joint.confidence, 0.0);
      EXPECT_EQ(joint.position, Vec3::Zero());
    }
  }
  expectSameShape({stream.frames.begin() + 1, stream.frames.end() - 1}, truth, 5e-6);
  EXPECT_EQ(stream.frames[11].time, 11.0 / 30.0);

  const auto nothing = parseJointStream(zeros + "\n" + zeros + "\n", "z.txt");
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().message, "z.txt: found no seen joint in 2 frames, expected at least one");
}

TEST(JointStream, AMissingHandIsWhereTheWristIs) {
  const std::vector<SkeletonFrame> truth = performance("wave", 5);
  std::string text = test::longFile(truth);
  for (std::size_t at = text.find("HandLeft"); at != std::string::npos; at = text.find("HandLeft", at + 1)) {
    const std::size_t end = text.find('\n', at);
    text.replace(at, end - at, "HandLeft,0,0,0");
  }
  const JointStream stream = parsed(text);
  const Vec3 forearm = truth[2][J::kLeftHand].position - truth[2][J::kLeftElbow].position;
  const Vec3 read = stream.frames[2][J::kLeftHand].position - stream.frames[2][J::kLeftElbow].position;
  EXPECT_LT((read - 0.8 * forearm).norm(), 1e-5);
}

TEST(JointStream, TimesInAnyUnit) {
  const std::vector<SkeletonFrame> truth = performance("walk", 30);
  const auto expectTimes = [&](double perSecond, std::string_view unit) {
    const JointStream stream = parsed(test::niteFile(truth, false, perSecond));
    EXPECT_TRUE(hasNote(stream, unit)) << perSecond;
    ASSERT_EQ(stream.frames.size(), truth.size());
    for (std::size_t f = 0; f < truth.size(); ++f) EXPECT_NEAR(stream.frames[f].time, truth[f].time, 1e-9) << perSecond;
  };
  expectTimes(1.0, "seconds");
  expectTimes(1e3, "milliseconds");
  expectTimes(1e6, "microseconds");
  expectTimes(1e7, "100 ns");
}

TEST(JointStream, TimesThatRepeatAreLeftOutAndClocksThatRestartGoOn) {
  std::vector<SkeletonFrame> rows = performance("walk", 90);
  const std::vector<SkeletonFrame> truth = rows;
  rows.insert(rows.begin() + 20, rows[19]);  // the same row again
  for (std::size_t f = 61; f < rows.size(); ++f) rows[f].time = truth[f - 61].time;
  const JointStream stream = parsed(test::niteFile(rows, false, 1000.0));
  expectSameShape(stream.frames, truth, 5e-6);
  for (std::size_t f = 1; f < stream.frames.size(); ++f) {
    EXPECT_NEAR(stream.frames[f].time - stream.frames[f - 1].time, 1.0 / 30.0, 1e-6) << f;
  }
  EXPECT_TRUE(hasNote(stream, "1 row repeats a time or goes back"));
  EXPECT_TRUE(hasNote(stream, "restarts 1 time:"));
}

TEST(JointStream, NiteOrientationsAreKeptWhereTheyAgreeWithTheLimbs) {
  const std::vector<SkeletonFrame> truth = performance("punch_and_kick", 60);
  const JointStream stream = parsed(test::niteFile(truth, true, 1.0));
  expectSameShape(stream.frames, truth, 5e-6);
  for (std::size_t f = 0; f < truth.size(); ++f) {
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      ASSERT_EQ(stream.frames[f].joints[j].orientation.has_value(), truth[f].joints[j].orientation.has_value());
      if (!truth[f].joints[j].orientation) continue;
      EXPECT_LT(stream.frames[f].joints[j].orientation->angularDistance(*truth[f].joints[j].orientation), 1e-5);
    }
  }
  std::vector<SkeletonFrame> other = truth;
  for (SkeletonFrame& frame : other) {
    for (TrackedJoint& joint : frame.joints) {
      if (joint.orientation) joint.orientation = *joint.orientation * Quat(Eigen::AngleAxisd(1.0, Vec3::UnitZ()));
    }
  }
  const JointStream doubtful = parsed(test::niteFile(other, true, 1.0));
  EXPECT_TRUE(hasNote(doubtful, "Orientations do not point along the limbs"));
  EXPECT_FALSE(doubtful.frames[0][J::kTorso].orientation);
}

TEST(JointStream, NiteInMetresAndWithAHeader) {
  const std::vector<SkeletonFrame> truth = performance("walk", 10);
  std::string text = "time,user";
  for (int j = 0; j < kBodyJointCount; ++j) {
    for (const char* field : {"x", "y", "z", "confidence"})
      text += fmt::format(",{}.{}", nameOf(static_cast<J>(j)), field);
  }
  text += '\n';
  for (const SkeletonFrame& frame : truth) {
    text += fmt::format("{},4", frame.time);
    for (const TrackedJoint& joint : frame.joints) {
      const Vec3 p = test::sensorFromWorld(joint.position);
      text += fmt::format(",{:.6f},{:.6f},{:.6f},1", p.x(), p.y(), p.z());
    }
    text += '\n';
  }
  const JointStream stream = parsed(text);
  EXPECT_EQ(stream.format, JointFormat::kNite2);
  EXPECT_EQ(stream.people, std::vector<int>{4});
  expectSameShape(stream.frames, truth, 5e-6);
  EXPECT_EQ(stream.firstGuess.at(0), "metres, since all numbers are below 20");
}

TEST(JointStream, WhoFacesTheSensorFacesPlusZWithTheLeftHandAtPlusX) {
  std::vector<SkeletonFrame> truth = performance("wave", 10);
  for (const test::JointFile& file : test::oneOfEach(truth)) {
    SCOPED_TRACE(nameOf(file.format));
    const JointStream stream = parsed(file.text);
    const SkeletonFrame& frame = stream.frames[0];
    EXPECT_GT(frame[J::kLeftShoulder].position.x() - frame[J::kRightShoulder].position.x(), 0.25);
    if (file.format == JointFormat::kUpperBody) continue;
    EXPECT_LT(std::hypot(frame[J::kTorso].position.x(), frame[J::kTorso].position.z()), 0.25);
  }
  const JointStream rightFirst = parsed(test::upperBodyFile(truth, false));
  expectSameShape(rightFirst.frames, truth, 5e-6, true);
  EXPECT_TRUE(hasNote(rightFirst, "The second arm of each row"));
}

TEST(JointStream, MirroredStreamsAreMirroredBack) {
  const std::vector<SkeletonFrame> truth = performance("walk", 120);
  std::vector<SkeletonFrame> mirrored = truth;
  for (SkeletonFrame& frame : mirrored) {
    for (TrackedJoint& joint : frame.joints) {
      joint.position.x() = -joint.position.x();
      if (joint.orientation) {
        joint.orientation =
            Quat(joint.orientation->w(), joint.orientation->x(), -joint.orientation->y(), -joint.orientation->z());
      }
    }
  }
  for (const std::string& text : {test::plainFile(mirrored), test::niteFile(mirrored, false, 1.0)}) {
    const JointStream stream = parsed(text);
    EXPECT_TRUE(hasNote(stream, "mirrored back"));
    expectSameShape(stream.frames, truth, 5e-6);
  }
}

TEST(JointStream, ATiltedSensorIsReportedNotCorrected) {
  std::vector<SkeletonFrame> truth = performance("wave", 30);
  EXPECT_FALSE(hasNote(parsed(test::plainFile(truth)), "tilted"));
  const Eigen::AngleAxisd tilt(20.0 * std::numbers::pi / 180.0, Vec3::UnitX());
  for (SkeletonFrame& frame : truth) {
    for (TrackedJoint& joint : frame.joints) joint.position = tilt * joint.position;
  }
  const JointStream stream = parsed(test::plainFile(truth));
  EXPECT_TRUE(hasNote(stream, "perhaps the sensor was tilted"));
  expectSameShape(stream.frames, truth, 5e-6);
}

TEST(JointStream, LoricaKeepsEveryBitAndLetsThePersonBeChosen) {
  std::vector<SkeletonFrame> walker = performance("walk", 60);
  std::vector<SkeletonFrame> rows = performance("squat_and_reach", 90);
  for (SkeletonFrame& frame : walker) frame.user = 2;
  rows.insert(rows.end(), walker.begin(), walker.end());
  const TemporaryFolder folder;
  const auto file = folder.path() / "two.csv";
  ASSERT_TRUE(writeJointCsv(file, rows));
  const auto max = test::valueOf(readJointStream(file));
  EXPECT_EQ(max.format, JointFormat::kLorica);
  EXPECT_EQ(max.people, (std::vector<int>{1, 2}));
  ASSERT_EQ(max.frames.size(), 60u);  // fewer frames than the other, but moving
  for (std::size_t f = 0; f < 60; ++f) {
    EXPECT_EQ(max.frames[f].time, walker[f].time);
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      EXPECT_EQ(max.frames[f].joints[j].position, walker[f].joints[j].position);
    }
  }
  EXPECT_EQ(readJointStream(file, {.person = 1})->frames.size(), 90u);
  EXPECT_FALSE(readJointStream(file, {.person = 3}));
}

TEST(JointStream, NamesOfFormatsAreReadBack) {
  for (int i = 0; i < kJointFormatCount; ++i) {
    const auto format = static_cast<JointFormat>(i);
    EXPECT_EQ(jointFormatNamed(nameOf(format)), format);
  }
  EXPECT_EQ(nameOf(JointFormat::kKinect2Bodies), "kinect2-bodies");
  EXPECT_FALSE(jointFormatNamed("Lorica"));
}

}  // namespace
}  // namespace lorica
