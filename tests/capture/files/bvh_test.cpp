#include "capture/files/bvh_file.h"

#include "capture/retarget/skeletal_retarget.h"
#include "geometry/random_numbers.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/figures.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

namespace lorica {
namespace {

/// Two joints and an end site, 1.5 units tall; five columns of many orders.
const std::string kHierarchy = R"(HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Spine
  {
    OFFSET 0 0.75 0
    CHANNELS 3 Yrotation Zrotation Xrotation
    End Site
    {
      OFFSET 0 0.75 0
    }
  }
}
)";

std::string with(const std::string& motion) {
  return kHierarchy + motion;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

bool anyNote(const BvhFile& file, const std::string& part) {
  for (const std::string& note : file.notes) {
    if (note.find(part) != std::string::npos) return true;
  }
  return false;
}

const std::string kMotion = "MOTION\nFrames: 2\nFrame Time: 0.04\n1 2 3 0 0 0 0 0 0\n1.5 2 3 90 0 0 0 0 0\n";

/// Checks that a text gives the motion of kHierarchy + kMotion.
void expectTheMotion(const std::string& text) {
  const BvhFile file = test::valueOf(parseBvh(text, "x.bvh"));
  ASSERT_EQ(file.motion.frameCount(), 2);
  EXPECT_DOUBLE_EQ(file.motion.times[1], 0.04);
  EXPECT_EQ(file.motion.pose(0)[0].translation, Vec3(1, 2, 3));
  EXPECT_EQ(file.motion.pose(1)[0].translation, Vec3(1.5, 2, 3));
  EXPECT_EQ(file.motion.pose(1)[1].translation, Vec3(0, 0.75, 0));
  EXPECT_LT((file.motion.pose(1)[0].rotation * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-12);
}

void expectRefused(const std::string& text, const std::string& sentence) {
  const Result<BvhFile> file = parseBvh(text, "x.bvh");
  ASSERT_FALSE(file) << text;
  EXPECT_EQ(file.error().message, sentence);
  EXPECT_EQ(file.error().code, ErrorCode::kBadFormat);
}

TEST(Bvh, PlainFile) {
  expectTheMotion(with(kMotion));
  const Result<BvhFile> file = parseBvh(with(kMotion), "x.bvh");
  EXPECT_EQ(file->unit, "metres");
  EXPECT_EQ(file->motion.skeleton.jointCount(), 2);
  EXPECT_EQ(file->motion.skeleton.joint(1).name, "Spine");
  EXPECT_EQ(file->motion.skeleton.joint(1).parent, 0);
  EXPECT_TRUE(file->notes.empty());
  EXPECT_EQ(file->firstGuess, (std::vector<std::string>{"rest pose: the zero pose",
                                                        "metres, since the rest pose measures 1.5 units (1.5 m)",
                                                        "Y is up, since head or feet are unknown"}));
}

TEST(Bvh, WritersHaveTheirOwnWays) {
  const std::string plain = with(kMotion);
  expectTheMotion(replaced(plain, "\n", "\r\n"));
  expectTheMotion(replaced(plain, "\n", "\r"));
  expectTheMotion(replaced(plain, "\n", "\n\n \t\n"));
  expectTheMotion(replaced(plain, " ", "\t"));
  expectTheMotion(replaced(plain, "\n", " \n"));
  expectTheMotion("\xef\xbb\xbf" + plain);
  expectTheMotion(plain + "\x1a");
  expectTheMotion(plain + std::string(3, '\0'));
  expectTheMotion(plain.substr(0, plain.size() - 1));
  expectTheMotion(replaced(replaced(plain, "ROOT", "root"), "JOINT", "Joint"));
  expectTheMotion(replaced(plain, "End Site", "END SITE"));
  expectTheMotion(replaced(plain, "End Site", "EndSite"));
  expectTheMotion(replaced(plain, "\n  {", " {"));
  expectTheMotion(replaced(plain, "Zrotation", "ZROTATION"));
  expectTheMotion(replaced(plain, "Frames:", "Frames :"));
  expectTheMotion(replaced(plain, "Frame Time:", "frame time"));
  expectTheMotion(replaced(replaced(plain, "Frames: ", "Frames:"), "Time: ", "Time:"));
  expectTheMotion(replaced(plain, "Frames: 2\nFrame Time: 0.04", "Frame Time: 4e-2\nFrames: 2"));
  expectTheMotion(replaced(plain, "1.5 2 3 90", "+1.5 2.0e0 .3E+1 90."));
  expectTheMotion(replaced(plain, "1.5 2 3", "1,5 2,0 3"));
  expectTheMotion(replaced(plain, "1.5 2 3", "1.5, 2, 3,"));
}

TEST(Bvh, NamesMayHaveBlanksAndColons) {
  const BvhFile file =
      test::valueOf(parseBvh(replaced(with(kMotion), "JOINT Spine", "JOINT  mixamorig:Left Up Leg\t"), "x"));
  EXPECT_EQ(file.motion.skeleton.joint(1).name, "mixamorig:Left Up Leg");
  const BvhFile unnamed = test::valueOf(parseBvh(replaced(with(kMotion), "JOINT Spine", "JOINT"), "x"));
  EXPECT_EQ(unnamed.motion.skeleton.joint(1).name, "joint2");
}

TEST(Bvh, FrameCountsMayBeWrong) {
  for (const char* count : {"1", "3", "0", "1000000000", "1e300", "-5"}) {
    const Result<BvhFile> file = parseBvh(replaced(with(kMotion), "Frames: 2", fmt::format("Frames: {}", count)), "x");
    if (std::string(count) == "1e300") {
      ASSERT_FALSE(file);
      EXPECT_EQ(file.error().message, "x, line 17: found '1e300', expected the number of frames");
      continue;
    }
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->motion.frameCount(), 2) << count;
    EXPECT_TRUE(anyNote(*file, ", the file has 2")) << count;
  }
}

TEST(Bvh, ChannelsThatAreNotKnownStayAsTheyWere) {
  const std::string head = "MOTION\nFrames: 3\nFrame Time: 0.04\n";
  const BvhFile file = test::valueOf(
      parseBvh(with(head + "nan 2 3 0 0 0 nan 0 0\n1 NaN 3 90 0 0 nan 0 0\n-nan(ind) 2 4 nan 0 0 NAN 0 0\n"), "x"));
  EXPECT_TRUE(anyNote(file, "7 numbers are NaN"));
  ASSERT_EQ(file.motion.frameCount(), 3);
  EXPECT_EQ(file.motion.pose(0)[0].translation, Vec3(1, 2, 3));
  EXPECT_EQ(file.motion.pose(1)[0].translation, Vec3(1, 2, 3));
  EXPECT_EQ(file.motion.pose(2)[0].translation, Vec3(1, 2, 4));
  EXPECT_EQ(file.motion.pose(2)[0].rotation.coeffs(), file.motion.pose(1)[0].rotation.coeffs());
  for (int f = 0; f < 3; ++f) EXPECT_EQ(file.motion.pose(f)[1].rotation.coeffs(), Quat::Identity().coeffs());
}

TEST(Bvh, AFrameCutShortIsLeftOut) {
  const BvhFile file = test::valueOf(parseBvh(with(kMotion) + "1 2 3 4\n", "x"));
  EXPECT_EQ(file.motion.frameCount(), 2);
  EXPECT_TRUE(anyNote(file, "line 21: the last frame lacks 5 of 9 numbers and is omitted"));
}

TEST(Bvh, FramesMayGoOnOverSeveralLines) {
  expectTheMotion(with("MOTION\nFrames: 2\nFrame Time: 0.04\n1 2 3\n0 0 0 0 0 0 1.5 2 3\n90 0 0 0 0 0\n"));
  expectRefused(with("MOTION\nFrames: 9\nFrame Time: 0.04\n1 2 3\n0 0 0 0 0 0 1.5 2 3\n90 0 0 0 0 0\n"),
                "x.bvh, line 19: found 3 numbers, expected 9: one per channel");
}

TEST(Bvh, FrameTimesBeyondBeliefAreThirtiethsOfASecond) {
  for (const char* time : {"0", "0.0", "-1", "1e-9", "33.3", "nan"}) {
    const BvhFile file =
        test::valueOf(parseBvh(replaced(with(kMotion), "Time: 0.04", fmt::format("Time: {}", time)), "x"));
    EXPECT_DOUBLE_EQ(file.motion.times[1], 1.0 / 30.0) << time;
    EXPECT_TRUE(anyNote(file, "is replaced by 1/30 s")) << time;
  }
}

TEST(Bvh, BadFilesAreRefusedWithTheLine) {
  expectRefused("", "x.bvh, line 1: the file ends here, expected HIERARCHY");
  expectRefused("PK\x03\x04", "x.bvh, line 1: found 'PK\\x03\\x04', expected HIERARCHY at the start of a BVH file");
  expectRefused(kHierarchy, "x.bvh, line 16: the file ends here, expected ROOT or MOTION");
  expectRefused(with("MOTION\nFrames: 2\n"),
                "x.bvh, line 18: the file ends here, expected \"Frames:\" and \"Frame Time:\"");
  expectRefused(with("MOTION\nFrames: 2\nFrame Time: 0.04\n"),
                "x.bvh, line 19: the file ends here, expected a frame of 9 numbers");
  expectRefused(with("MOTION\nFrames: two\nFrame Time: 0.04\n"),
                "x.bvh, line 17: found 'two', expected the number of frames");
  expectRefused(replaced(with(kMotion), "90 0 0", "90 inf 0"),
                "x.bvh, line 20: found 'inf' in column 5, expected a number between -1e9 and 1e9");
  expectRefused(replaced(with(kMotion), "90 0 0", "90 0x1 0"),
                "x.bvh, line 20: found '0x1' in column 5, expected a number between -1e9 and 1e9");
  expectRefused(replaced(with(kMotion), "90 0 0", "90 1e10 0"),
                "x.bvh, line 20: found '1e10' in column 5, expected a number between -1e9 and 1e9");
  expectRefused(replaced(with(kMotion), "90 0 0", "90 10000000000 0"),
                "x.bvh, line 20: found 10000000000 in column 5, expected a number between -1e9 and 1e9");
  expectRefused(replaced(with(kMotion), "1.5 2 3", "1.5 2 3 4"),
                "x.bvh, line 20: found 10 numbers, expected 9: one per channel");
  expectRefused(with("MOTION\nFrames: 3\nFrame Time: 0.04\n1 2 3 0 0 0 0 0 0\n1 2 3\n1 2 3 0 0 0 0 0 0\n"),
                "x.bvh, line 20: found 3 numbers, expected 9: one per channel");
  expectRefused(replaced(with(kMotion), "OFFSET 0 0.75 0", "OFFSET 0 up 0"),
                "x.bvh, line 8: found 'up', expected the y of an offset");
  expectRefused(replaced(with(kMotion), "CHANNELS 3", "CHANNELS 4"),
                "x.bvh, line 10: found 'End', expected channel 4 of 4, for example Xposition or Zrotation");
  expectRefused(replaced(with(kMotion), "CHANNELS 3", "CHANNELS 99999999999"),
                "x.bvh, line 9: found '99999999999', expected a channel count from 0 to 12");
  expectRefused(replaced(with(kMotion), "    End Site\n", "    Finish\n"),
                "x.bvh, line 10: found 'Finish', expected OFFSET, CHANNELS, JOINT, End Site or } of the joint 'Spine'");
  expectRefused("HIERARCHY\nMOTION\n", "x.bvh, line 2: found MOTION before any ROOT, expected a ROOT");
  expectRefused("HIERARCHY\nROOT a\n{\n}\nMOTION\n",
                "x.bvh, line 5: found no CHANNELS, expected them on at least one joint");
}

TEST(Bvh, EveryPrefixOfAFileFailsCleanlyOrReads) {
  const std::string text = with(kMotion);
  const std::size_t firstFrame = text.find('\n', text.find("Frame Time")) + 1;
  const SkeletalMotion whole = parseBvh(text, "x").value().motion;
  for (std::size_t length = 0; length <= text.size(); ++length) {
    // A buffer of exactly that size, so that a sanitizer sees any byte read beyond it.
    const std::vector<char> prefix(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(length));
    const Result<BvhFile> file = parseBvh({prefix.data(), prefix.size()}, "x");
    if (file) {
      // Frames that are missing at the end are left out; only the last number of the last one may be cut.
      EXPECT_GE(length, firstFrame) << length;
      ASSERT_LE(file->motion.frameCount(), whole.frameCount()) << length;
      for (int f = 0; f + 1 < file->motion.frameCount(); ++f) {
        for (int j = 0; j < whole.skeleton.jointCount(); ++j) {
          EXPECT_EQ(file->motion.pose(f)[j].rotation.coeffs(), whole.pose(f)[j].rotation.coeffs()) << length;
          EXPECT_EQ(file->motion.pose(f)[j].translation, whole.pose(f)[j].translation) << length;
        }
      }
    } else {
      EXPECT_EQ(file.error().message.substr(0, 8), "x, line ") << length;
    }
  }
}

TEST(Bvh, DeepHierarchiesNeedNoStack) {
  const auto chain = [](std::size_t joints) {
    std::string text = "HIERARCHY\nROOT j\n{\nOFFSET 0 1 0\nCHANNELS 1 Xrotation\n";
    for (std::size_t i = 1; i < joints; ++i) text += "JOINT j\n{\nOFFSET 0 1 0\nCHANNELS 1 Xrotation\n";
    text += std::string(joints, '}') + "\nMOTION\nFrames: 1\nFrame Time: 0.1\n";
    for (std::size_t i = 0; i < joints; ++i) text += "0 ";
    return text;
  };
  EXPECT_TRUE(parseBvh(chain(10000), "x"));
  const Result<BvhFile> tooMany = parseBvh(chain(10001), "x");
  ASSERT_FALSE(tooMany);
  EXPECT_EQ(tooMany.error().message, "x, line 40002: found joint 10001, expected at most 10000");
}

TEST(Bvh, SmallFilesTakeLittleMemory) {
  // 1,000 joints without channels and 100,000 frames of two bytes would be 10 GB of poses.
  std::string text = "HIERARCHY\nROOT r\n{\nOFFSET 0 1 0\nCHANNELS 1 Xrotation\n";
  for (int i = 0; i < 1000; ++i) text += "JOINT j { }\n";
  text += "}\nMOTION\nFrames: 100000\nFrame Time: 0.1\n";
  for (int i = 0; i < 100000; ++i) text += "0\n";
  const Result<BvhFile> file = parseBvh(text, "x");
  ASSERT_FALSE(file);
  EXPECT_NE(file.error().message.find("too many for a file of"), std::string::npos) << file.error().message;
}

TEST(Bvh, SeveralRootsAndJointsOfNoLength) {
  std::string text = with(kMotion);
  text = replaced(text, "MOTION\n",
                  "ROOT Prop\n{\nOFFSET 0 0 0\nCHANNELS 1 Xposition\nJOINT p\n{\nOFFSET 0 0 0\n}\n}\nMOTION\n");
  text = replaced(text, "0 0 0\n1.5", "0 0 0 7\n1.5");
  text.insert(text.size() - 1, " 8");
  const BvhFile file = test::valueOf(parseBvh(text, "x"));
  ASSERT_EQ(file.motion.skeleton.jointCount(), 4);
  EXPECT_EQ(file.motion.skeleton.joint(2).parent, kNoJoint);
  EXPECT_EQ(file.motion.pose(1)[2].translation, Vec3(8, 0, 0));
  EXPECT_EQ(file.motion.pose(1)[3].translation, Vec3(0, 0, 0));
}

TEST(Bvh, TheUnitIsTheOneThatMakesAPerson) {
  const auto unitOf = [](double height) {
    const std::string half = fmt::format("OFFSET 0 {} 0", 0.5 * height);
    const Result<BvhFile> file = parseBvh(replaced(with(kMotion), "OFFSET 0 0.75 0", half), "x");
    EXPECT_TRUE(file);
    EXPECT_EQ(file->motion.pose(0)[0].translation, Vec3(file->metresPerUnit * Vec3(1, 2, 3)));
    EXPECT_TRUE(file->firstGuess.at(1).starts_with(file->unit));
    return file->unit;
  };
  EXPECT_EQ(unitOf(1.6), "metres");
  EXPECT_EQ(unitOf(2.2), "metres");
  EXPECT_EQ(unitOf(165.0), "centimetres");
  EXPECT_EQ(unitOf(140.0), "centimetres");
  EXPECT_EQ(unitOf(1750.0), "millimetres");
  EXPECT_EQ(unitOf(68.0), "inches");
  EXPECT_EQ(unitOf(17.0), "decimetres");
  EXPECT_EQ(unitOf(60.0), "inches");
  EXPECT_EQ(unitOf(45.0), "a unit of its own (3.778 cm)");  // as inches 1.14 m, as centimetres 0.45 m
  EXPECT_EQ(unitOf(31.0), "units of the CMU database (5.644 cm)");
  EXPECT_EQ(unitOf(0.0), "metres");
  const Result<BvhFile> giant = parseBvh(replaced(with(kMotion), "OFFSET 0 0.75 0", "OFFSET 0 50000 0"), "x");
  EXPECT_TRUE(anyNote(*giant, "no unit gives 0.5 to 2.5 m"));
}

TEST(Bvh, PositionsBelowTheRootReplaceOffsetsOrAddToThem) {
  const std::string six = replaced(with(kMotion), "CHANNELS 3", "CHANNELS 6 Xposition Yposition Zposition");
  const auto spineOf = [&](const std::string& first, const std::string& second) {
    std::string text = replaced(six, "3 0 0 0 0 0 0\n", "3 0 0 0 " + first + " 0 0 0\n");
    text = replaced(text, "3 90 0 0 0 0 0\n", "3 90 0 0 " + second + " 0 0 0\n");
    const Result<BvhFile> file = parseBvh(text, "x");
    EXPECT_TRUE(file);
    return file->motion.pose(1)[1].translation;
  };
  EXPECT_EQ(spineOf("0 0.75 0", "0 0.80 0.125"), Vec3(0, 0.8, 0.125));
  EXPECT_EQ(spineOf("0 0 0", "0 0 0.125"), Vec3(0, 0.75, 0.125));
}

TEST(Bvh, ARootThatNeverMovesStaysAtItsOffset) {
  std::string text = replaced(with(kMotion), "Hips\n{\n  OFFSET 0 0 0", "Hips\n{\n  OFFSET 0 0.9 0");
  text = replaced(replaced(text, "1 2 3", "0 0 0"), "1.5 2 3", "0 0 0");
  const BvhFile file = test::valueOf(parseBvh(text, "x"));
  EXPECT_EQ(file.motion.pose(1)[0].translation, Vec3(0, 0.9, 0));
}

TEST(Bvh, WhatTheFuzzerStartsFromIsReadOrRefused) {
  const std::filesystem::path folder = test::recordingsFolder().parent_path() / "tests" / "fuzz" / "corpus" / "bvh";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path().filename());
    ++files;
    const Result<BvhFile> file = readBvh(entry.path());
    if (!file) {
      EXPECT_NE(file.error().message.find("expected"), std::string::npos) << file.error().message;
      continue;
    }
    EXPECT_LE(file->motion.poses.size(), std::filesystem::file_size(entry.path()));
    for (const JointTransform& t : file->motion.poses) {
      ASSERT_TRUE(t.translation.allFinite() && t.rotation.coeffs().allFinite());
    }
    const Result<SkeletalMotion> carried = retargetMotion(file->motion, makeMannequin().skeleton);
    if (!carried) continue;
    for (const JointTransform& t : carried->poses) {
      ASSERT_TRUE(t.translation.allFinite() && t.rotation.coeffs().allFinite());
    }
  }
  EXPECT_GE(files, 7);
}

// An independent evaluation that shares no code with the reader: words by stream, a 4x4 matrix per channel.

struct SlowJoint {
  int parent;
  Vec3 offset;
  std::vector<std::string> channels;
};

struct SlowBvh {
  std::vector<SlowJoint> joints;
  std::vector<std::vector<double>> rows;

  explicit SlowBvh(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string word;
    std::vector<int> stack;
    std::size_t columns = 0;
    while (in >> word && word != "MOTION") {
      if (word == "ROOT" || word == "JOINT") {
        in >> word;
        joints.push_back({stack.empty() ? -1 : stack.back(), Vec3::Zero(), {}});
        stack.push_back(static_cast<int>(joints.size()) - 1);
      } else if (word == "End") {
        stack.push_back(-2);
      } else if (word == "OFFSET") {
        Vec3 v;
        in >> v[0] >> v[1] >> v[2];
        if (stack.back() >= 0) joints[stack.back()].offset = v;
      } else if (word == "CHANNELS") {
        std::size_t count = 0;
        in >> count;
        columns += count;
        auto& channels = joints[stack.back()].channels;
        channels.resize(count);
        for (std::string& channel : channels) in >> channel;
      } else if (word == "}") {
        stack.pop_back();
      }
    }
    while (in >> word && word != "Time:") {
    }
    in >> word;
    std::vector<double> all;
    for (double value = 0.0; in >> value;) all.push_back(value);
    for (std::size_t i = 0; i + columns <= all.size(); i += columns) {
      rows.emplace_back(all.begin() + static_cast<std::ptrdiff_t>(i),
                        all.begin() + static_cast<std::ptrdiff_t>(i + columns));
    }
  }

  /// Positions of all joints in the file's unit and axes. @param relative  joint positions are added to their offsets
  [[nodiscard]] std::vector<Vec3> positions(std::size_t frame, bool relative, bool rootAtOffset) const {
    std::vector<Mat4> world;
    std::vector<Vec3> out;
    std::size_t column = 0;
    for (const SlowJoint& joint : joints) {
      const bool add = joint.parent < 0 ? rootAtOffset : relative;
      Vec3 position = joint.offset;
      Mat4 turn = Mat4::Identity();
      for (const std::string& channel : joint.channels) {
        const double value = rows[frame][column++];
        const int axis = channel[0] - 'X';
        if (channel.substr(1) == "position") {
          position[axis] = (add ? joint.offset[axis] : 0.0) + value;
          continue;
        }
        const double c = std::cos(value * std::numbers::pi / 180.0);
        const double s = std::sin(value * std::numbers::pi / 180.0);
        Mat4 one = Mat4::Identity();
        const int a = (axis + 1) % 3;
        const int b = (axis + 2) % 3;
        one(a, a) = c;
        one(b, b) = c;
        one(a, b) = -s;
        one(b, a) = s;
        turn = turn * one;
      }
      Mat4 local = Mat4::Identity();
      local.block<3, 1>(0, 3) = position;
      local = local * turn;
      world.push_back(joint.parent < 0 ? local : Mat4(world[joint.parent] * local));
      out.emplace_back(world.back().block<3, 1>(0, 3));
    }
    return out;
  }
};

struct SharedFile {
  const char* path;
  int joints;
  int frames;
  const char* unit;
  bool zUp;
  bool relative;
  bool rootAtOffset;
};

class SharedBvh : public ::testing::TestWithParam<SharedFile> {};

TEST_P(SharedBvh, PositionsEqualAProductOfMatrices) {
  const SharedFile& expected = GetParam();
  LORICA_REQUIRE_DATASET(path, expected.path);
  const BvhFile file = test::valueOf(readBvh(path));
  const SkeletalMotion& motion = file.motion;
  EXPECT_EQ(motion.skeleton.jointCount(), expected.joints);
  EXPECT_EQ(motion.frameCount(), expected.frames);
  EXPECT_EQ(file.unit, expected.unit);
  EXPECT_EQ(file.firstGuess.at(2), expected.zUp ? "Z is up, rotated so that Y is up" : "Y is up");
  const SlowBvh slow(path);
  ASSERT_EQ(slow.rows.size(), motion.times.size());
  for (std::size_t f = 0; f < slow.rows.size(); f += 7) {
    const std::vector<Vec3> positions = slow.positions(f, expected.relative, expected.rootAtOffset);
    const std::span<const JointTransform> pose = motion.pose(static_cast<int>(f));
    const std::vector<Affine3> world = test::worldOf(motion.skeleton, Pose(pose.begin(), pose.end()));
    ASSERT_EQ(positions.size(), world.size());
    for (std::size_t j = 0; j < positions.size(); ++j) {
      Vec3 position = file.metresPerUnit * positions[j];
      if (expected.zUp) position = Vec3(position.x(), position.z(), -position.y());
      ASSERT_LT((world[j].translation() - position).norm(), 1e-9) << "frame " << f << " joint " << j;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, SharedBvh,
    ::testing::Values(SharedFile{"bvh/animated_drawings/jumping_jacks.bvh", 31, 125,
                                 "units of the CMU database (5.644 cm)", false, false, false},
                      SharedFile{"bvh/animated_drawings/zombie.bvh", 27, 779, "a unit of its own (3.748 cm)", true,
                                 false, false},
                      SharedFile{"bvh/makehuman/walk1.bvh", 75, 14, "decimetres", true, false, true},
                      SharedFile{"bvh/makehuman/zombieWalk1.bvh", 75, 31, "decimetres", true, false, false},
                      SharedFile{"bvh/makehuman/tpose.bvh", 173, 1, "decimetres", true, true, false}),
    [](const auto& chosen) { return std::filesystem::path(chosen.param.path).stem().string(); });

/// Compares world positions of all joints of both motions, frame by frame. @return the largest distance [m]
double largestDistance(const SkeletalMotion& a, const SkeletalMotion& b) {
  double largest = 0.0;
  for (int f = 0; f < a.frameCount(); ++f) {
    const std::vector<Affine3> worldA = test::worldOf(a.skeleton, Pose(a.pose(f).begin(), a.pose(f).end()));
    const std::vector<Affine3> worldB = test::worldOf(b.skeleton, Pose(b.pose(f).begin(), b.pose(f).end()));
    for (const Affine3& m : worldA) {
      const auto j = static_cast<std::size_t>(&m - worldA.data());
      const std::string& name = a.skeleton.joint(static_cast<JointIndex>(j)).name;
      for (std::size_t k = 0; k < worldB.size(); ++k) {
        if (b.skeleton.joint(static_cast<JointIndex>(k)).name != name) continue;
        largest = std::max(largest, (m.translation() - worldB[k].translation()).norm());
      }
    }
  }
  return largest;
}

/// Random rotations of all joints, translations of the hips and of one joint below them.
SkeletalMotion randomMotion(const Skeleton& skeleton, std::uint64_t seed) {
  RandomNumbers random(seed);
  SkeletalMotion motion;
  motion.skeleton = skeleton;
  for (int f = 0; f < 20; ++f) {
    motion.times.push_back(0.04 * f);
    Pose pose = restPose(skeleton);
    for (JointTransform& joint : pose) {
      Quat turn;
      for (int i = 0; i < 4; ++i) turn.coeffs()[i] = random.between(-1.0, 1.0);
      if (turn.norm() > 0.1) joint.rotation = turn.normalized();
    }
    for (int i = 0; i < 3; ++i) pose[0].translation[i] = random.between(-2.0, 2.0);
    pose[5].translation += Vec3(0.1 * f, 0, 0);
    motion.poses.insert(motion.poses.end(), pose.begin(), pose.end());
  }
  return motion;
}

TEST(BvhWriter, ReadingWhatWasWrittenGivesTheSamePositions) {
  const test::TemporaryFolder folder;
  std::vector<SkeletalMotion> motions;
  motions.push_back(randomMotion(makeMannequin().skeleton, 1));
  test::FigureSettings settings;
  settings.armature = true;
  settings.crookedAxes = true;
  motions.push_back(randomMotion(test::makeFigure(settings).skeleton, 2));
  for (SkeletalMotion& motion : motions) {
    const std::filesystem::path file = folder.path() / "out.bvh";
    const Result<void> written = writeBvh(file, motion);
    ASSERT_TRUE(written) << written.error().message;
    const BvhFile read = test::valueOf(readBvh(file));
    EXPECT_EQ(read.unit, "centimetres");
    ASSERT_EQ(read.motion.frameCount(), motion.frameCount());
    EXPECT_NEAR(read.motion.times.back(), motion.times.back(), 1e-6);
    EXPECT_LT(largestDistance(motion, read.motion), 1e-4);
  }
}

TEST(BvhWriter, SharedFilesGoRound) {
  for (const char* path : {"bvh/animated_drawings/jumping_jacks.bvh", "bvh/makehuman/zombieWalk1.bvh"}) {
    LORICA_REQUIRE_DATASET(file, path);
    const test::TemporaryFolder folder;
    const BvhFile first = test::valueOf(readBvh(file));
    ASSERT_TRUE(writeBvh(folder.path() / "out.bvh", first.motion));
    const BvhFile second = test::valueOf(readBvh(folder.path() / "out.bvh"));
    EXPECT_EQ(second.unit, "centimetres");
    EXPECT_FALSE(anyNote(second, "rotated"));
    ASSERT_EQ(second.motion.frameCount(), first.motion.frameCount());
    EXPECT_LT(largestDistance(first.motion, second.motion), 1e-4);
  }
}

TEST(BvhWriter, UnevenTimesBecomeEven) {
  const test::TemporaryFolder folder;
  SkeletalMotion motion;
  motion.skeleton = makeMannequin().skeleton;
  for (const double time : {0.0, 0.1, 0.15, 0.3}) {
    motion.times.push_back(time);
    Pose pose = restPose(motion.skeleton);
    pose[0].translation = Vec3(time, 1.0, 0.0);
    motion.poses.insert(motion.poses.end(), pose.begin(), pose.end());
  }
  ASSERT_TRUE(writeBvh(folder.path() / "out.bvh", motion));
  const BvhFile read = test::valueOf(readBvh(folder.path() / "out.bvh"));
  for (int f = 0; f < 4; ++f) {
    EXPECT_NEAR(read.motion.times[f], 0.1 * f, 1e-9);
    EXPECT_NEAR(read.motion.pose(f)[0].translation.x(), 0.1 * f, 1e-6);
  }
}

TEST(BvhWriter, AMotionWithoutFramesIsRefused) {
  SkeletalMotion motion;
  motion.skeleton = makeMannequin().skeleton;
  EXPECT_FALSE(writeBvh("x.bvh", motion));
}

}  // namespace
}  // namespace lorica
