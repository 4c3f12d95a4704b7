#include "capture/sensor/oni_joints.h"

#include "capture/files/joint_csv.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <limits>

namespace lorica {
namespace {

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
