#include "capture/sensor/oni_depth_codec.h"

#include "capture/files/joint_csv.h"
#include "capture/sensor/depth_frame.h"
#include "geometry/random_numbers.h"
#include "tests/capture/sensor/oni_writer.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <limits>
#include <string>
#include <vector>

namespace lorica {
namespace {

constexpr OniCodec kCodecs[] = {OniCodec::kRaw, OniCodec::kPacked, OniCodec::kTable};

std::span<const std::uint8_t> bytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Surfaces with edges, holes and uniform walls, so that every packing mode occurs.
std::vector<std::uint16_t> someDepths(RandomNumbers& random, std::size_t count, double rough) {
  std::vector<std::uint16_t> depths(count);
  double depth = 2000.0;
  for (std::uint16_t& d : depths) {
    const double dice = random.unit();
    if (dice < 0.05 * rough) depth = random.between(400.0, 9000.0);
    if (dice > 1.0 - rough) depth += random.between(-9.0, 9.0);
    d = dice > 0.4 && dice < 0.4 + 0.1 * rough ? std::uint16_t{0} : static_cast<std::uint16_t>(depth);
  }
  return depths;
}

TEST(OniDepthCodec, BytesMeanWhatTheFormatSays) {
  // 1000; 1000 + 1 and + 6; + 0 and a difference of -20; two pairs alike; 0x1234; 0x1235 alone.
  const std::string packed("\xe8\x03\x50\x6f\xac\xe2\xff\x12\x34\x5d", 10);
  const std::vector<std::uint16_t> expected = {1000, 1001, 1007, 1007, 1027, 1027, 1027, 1027, 1027, 0x1234, 0x1235};
  std::vector<std::uint16_t> depths(expected.size());
  OniDepthDecoder decoder;
  const Result<void> decoded = decoder.decode(OniCodec::kPacked, bytesOf(packed), depths);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(depths, expected);
}

TEST(OniDepthCodec, UnpackingUndoesPacking) {
  RandomNumbers random(7);
  OniDepthDecoder decoder;
  for (const OniCodec codec : kCodecs) {
    for (const std::size_t count : {1, 2, 3, 30, 31, 32, 33, 1000, 1001}) {
      for (const double rough : {0.0, 0.02, 0.3, 1.0}) {
        const std::vector<std::uint16_t> depths = someDepths(random, count, rough);
        std::vector<std::uint16_t> read(count, 1);
        const Result<void> decoded = decoder.decode(codec, bytesOf(packOniDepth(codec, depths)), read);
        ASSERT_TRUE(decoded) << decoded.error().message;
        ASSERT_EQ(read, depths) << count << " pixels, roughness " << rough;
      }
    }
  }
}

TEST(OniDepthCodec, ImagesOfAnotherSizeAreRefused) {
  RandomNumbers random(8);
  OniDepthDecoder decoder;
  for (const OniCodec codec : kCodecs) {
    const std::string packed = packOniDepth(codec, someDepths(random, 100, 0.3));
    std::vector<std::uint16_t> fewer(99);
    std::vector<std::uint16_t> more(101);
    EXPECT_FALSE(decoder.decode(codec, bytesOf(packed), fewer));
    EXPECT_FALSE(decoder.decode(codec, bytesOf(packed), more));
    EXPECT_FALSE(decoder.decode(codec, {}, fewer));
  }
}

TEST(OniDepthCodec, ValuesBeyondTheTableAreRefused) {
  // One entry, 700. The second pixel refers to entry 1, as a value and as a difference.
  std::vector<std::uint16_t> depths(2);
  OniDepthDecoder decoder;
  EXPECT_TRUE(decoder.decode(OniCodec::kTable, bytesOf(std::string("\1\0\xbc\2\0\0\x6d", 7)), depths));
  EXPECT_FALSE(decoder.decode(OniCodec::kTable, bytesOf(std::string("\1\0\xbc\2\0\0\xff\0\1", 9)), depths));
  EXPECT_FALSE(decoder.decode(OniCodec::kTable, bytesOf(std::string("\1\0\xbc\2\0\0\x5d", 7)), depths));
  EXPECT_FALSE(decoder.decode(OniCodec::kTable, bytesOf(std::string("\0\0\0\0", 4)), depths)) << "an empty table";
  EXPECT_FALSE(decoder.decode(OniCodec::kTable, bytesOf(std::string("\xff\xff\0\0", 4)), depths))
      << "a truncated table";
}

TEST(OniDepthCodec, AnyBytesGiveAnImageOrASentence) {
  RandomNumbers random(9);
  OniDepthDecoder decoder;
  std::vector<std::uint16_t> depths(64);
  int images = 0;
  for (int i = 0; i < 20000; ++i) {
    const OniCodec codec = kCodecs[i % 3];
    std::string packed = packOniDepth(codec, someDepths(random, 64, 0.5));
    for (int flips = 1 + static_cast<int>(3.0 * random.unit()); flips > 0; --flips) {
      packed[random.bits() % packed.size()] ^= static_cast<char>(1 + random.bits() % 255);
    }
    if (i % 7 == 0) packed.resize(random.bits() % packed.size());
    // Heap blocks of exactly this size, so that a sanitizer detects any read beyond them.
    const std::vector<std::uint8_t> exact(packed.begin(), packed.end());
    const Result<void> decoded = decoder.decode(codec, exact, depths);
    if (decoded) ++images;
    if (!decoded) {
      EXPECT_NE(decoded.error().message.find("expected"), std::string::npos) << decoded.error().message;
    }
  }
  EXPECT_GT(images, 1000) << "mostly flipped depths";
  EXPECT_LT(images, 19000);
}

TEST(DepthCamera, TheImagesEdgesLieAtHalfTheFieldOfView) {
  const DepthCamera camera;
  const Vec3 left = camera.positionOf(-0.5, 239.5, 2.0);  // the left border of the left column
  EXPECT_NEAR(std::atan2(-left.x(), -left.z()), 0.5 * camera.horizontalFov, 1e-12);
  EXPECT_NEAR(left.y(), 0.0, 1e-12);
  EXPECT_DOUBLE_EQ(left.z(), -2.0);
  const Vec3 top = camera.positionOf(319.5, -0.5, 2.0);
  EXPECT_NEAR(std::atan2(top.y(), -top.z()), 0.5 * camera.verticalFov, 1e-12);
}

TEST(DepthCamera, SeesAPositionWhereItWasComputedFrom) {
  const DepthCamera camera;
  for (const double column : {-0.5, 0.0, 100.25, 639.5}) {
    for (const double row : {0.0, 300.75}) {
      const Eigen::Vector2d point = camera.imagePointOf(camera.positionOf(column, row, 1.7));
      EXPECT_NEAR(point.x(), column + 0.5, 1e-10);
      EXPECT_NEAR(point.y(), row + 0.5, 1e-10);
    }
  }
}

SkeletonFrame someFrame(int number, int user = 1) {
  SkeletonFrame frame;
  frame.time = number / 30.0;
  frame.user = user;
  for (int j = 0; j < kBodyJointCount; ++j) {
    TrackedJoint& joint = frame.joints[j];
    joint.position = Vec3(0.1 * j + number / 7.0, 1.0 / (1 + j), -0.3);
    if (j % 2 == 0) joint.orientation = Quat(Eigen::AngleAxisd(0.1 * number + j, Vec3::UnitY()));
    joint.confidence = 0.5 * (j % 3);
  }
  return frame;
}

void expectSame(const SkeletonFrame& read, const SkeletonFrame& written) {
  EXPECT_EQ(read.time, written.time);
  for (std::size_t j = 0; j < read.joints.size(); ++j) {
    EXPECT_EQ(read.joints[j].position, written.joints[j].position);
    EXPECT_EQ(read.joints[j].confidence, written.joints[j].confidence);
    ASSERT_EQ(read.joints[j].orientation.has_value(), written.joints[j].orientation.has_value());
    if (read.joints[j].orientation) {
      EXPECT_TRUE(read.joints[j].orientation->isApprox(*written.joints[j].orientation, 1e-12));
    }
  }
}

TEST(JointCsvWriter, WhatIsWrittenIsReadAtAnyTime) {
  const test::TemporaryFolder folder;
  JointCsvWriter writer = test::valueOf(JointCsvWriter::create(folder.path() / "body.csv"));
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(writer.add(someFrame(i)));
    const std::vector<SkeletonFrame> now = test::valueOf(readJointCsv(folder.path() / "body.part.csv"));
    EXPECT_EQ(now.size(), static_cast<std::size_t>(i + 1));
  }
  ASSERT_TRUE(writer.add(someFrame(2, 7)));
  const int rows = test::valueOf(writer.finish());
  EXPECT_EQ(rows, 6);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "body.part.csv"));
  const std::vector<SkeletonFrame> read = test::valueOf(readJointCsv(folder.path() / "body.csv"));
  ASSERT_EQ(read.size(), 5u);
  for (int i = 0; i < 5; ++i) expectSame(read[i], someFrame(i));
}

TEST(JointCsvWriter, FramesThatNobodyCouldReadAreLeftOut) {
  const test::TemporaryFolder folder;
  JointCsvWriter writer = test::valueOf(JointCsvWriter::create(folder.path() / "body.csv"));
  ASSERT_TRUE(writer.add(someFrame(3)));
  EXPECT_FALSE(writer.add(someFrame(3))) << "the same time again";
  EXPECT_FALSE(writer.add(someFrame(2))) << "back in time";
  SkeletonFrame bad = someFrame(4);
  bad.joints[3].position.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(writer.add(bad));
  bad = someFrame(4);
  bad.joints[3].position.x() = 2500.0;
  EXPECT_FALSE(writer.add(bad)) << "millimetres";
  EXPECT_TRUE(writer.add(someFrame(4)));
  const int rows = test::valueOf(writer.finish());
  EXPECT_EQ(rows, 2);
  EXPECT_TRUE(readJointCsv(folder.path() / "body.csv"));
}

TEST(JointCsvWriter, WhereNobodyWasSeenThereIsNoFile) {
  const test::TemporaryFolder folder;
  JointCsvWriter writer = test::valueOf(JointCsvWriter::create(folder.path() / "body.csv"));
  const int rows = test::valueOf(writer.finish());
  EXPECT_EQ(rows, 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  const Result<JointCsvWriter> nowhere = JointCsvWriter::create(folder.path() / "none" / "body.csv");
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code, ErrorCode::kUnwritable);
}

TEST(JointCsvWriter, AKilledProgramLosesNoJoints) {
  const test::TemporaryFolder folder;
  int done[2];
  ASSERT_EQ(pipe(done), 0);
  const pid_t child = fork();
  if (child == 0) {
    Result<JointCsvWriter> writer = JointCsvWriter::create(folder.path() / "body.csv");
    for (int i = 0; i < 100; ++i) {
      if (!writer || !writer->add(someFrame(i))) _exit(1);
      if (write(done[1], "x", 1) != 1) _exit(2);  // after each row: tells the parent which rows must be there
    }
    pause();
    _exit(0);
  }
  close(done[1]);
  char bytes[64];
  int rows = 0;
  while (rows < 64) {
    const ssize_t got = read(done[0], bytes, static_cast<std::size_t>(64 - rows));
    ASSERT_GT(got, 0) << "the child failed";
    rows += static_cast<int>(got);
  }
  kill(child, SIGKILL);  // while it is writing
  int status = 0;
  waitpid(child, &status, 0);
  close(done[0]);
  ASSERT_TRUE(WIFSIGNALED(status));
  const std::vector<SkeletonFrame> frames = test::valueOf(readJointCsv(folder.path() / "body.part.csv"));
  EXPECT_GE(frames.size(), 64u);
  for (std::size_t i = 0; i < frames.size(); ++i) expectSame(frames[i], someFrame(static_cast<int>(i)));
}

}  // namespace
}  // namespace lorica
