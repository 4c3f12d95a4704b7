#include "geometry/hard_stop.h"

#include "geometry/files.h"
#include "session/recording/session_file.h"
#include "tests/apps/faults/faulty_run.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

/// 300,000 drops that settle for 600 frames: minutes of work in the first step.
constexpr const char* kFlood = R"({"format": "lorica scene 1", "water": {"spacing": 0.008, "settle": 20,
  "fill": [{"at": [0, 10, 0], "size": [20, 20, 20]}]}})";

std::size_t filesLeft(const fs::path& folder) {
  std::size_t count = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) count += entry.is_regular_file();
  return count;
}

class HardStop : public testing::Test {
 protected:
  HardStop() {
    folder.write("flood.json", kFlood);
    const FaultyEnd made = run({"decompose", "mannequin", "--parts", "3", "--keyframes", "2", "-o", "b.lorica"}, {});
    EXPECT_EQ(made.exitCode, 0) << made.err;
  }
  FaultyEnd run(std::vector<std::string> arguments, Fault fault, std::function<bool()> ready = {}) const {
    return runWithFault({std::move(arguments), folder.path(), folder.path() / "cache", fault, std::move(ready)});
  }
  TemporaryFolder folder;
};

TEST_F(HardStop, SettlingIsEndedByEachSignalAndRecordsNothing) {
  for (const auto& [fault, status] :
       {std::pair(Fault::kInterrupt, 130), std::pair(Fault::kTerminate, 143), std::pair(Fault::kHangUp, 129)}) {
    SCOPED_TRACE(nameOf(fault));
    const fs::path part = folder.path() / "o.part.lsession";
    const auto isRecording = [&] {
      std::error_code none;
      if (!fs::exists(part, none)) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(500));  // the first step, in which they settle, has begun
      return true;
    };
    const FaultyEnd end = run({"record", "o.lsession", "walk", "--decomposition", "b.lorica", "--scene", "flood.json"},
                              fault, isRecording);
    // 0: the frame that settled was done before the hard stop.
    EXPECT_TRUE(end.exitCode == status || end.exitCode == 0) << end.exitCode << ": " << end.err;
    EXPECT_LT(end.secondsAfterSignal, 60.0) << "a second, unless the machine is busy";
    EXPECT_FALSE(fs::exists(part)) << "no step was recorded";
    EXPECT_FALSE(fs::exists(folder.path() / "o.lsession"));
  }
}

TEST_F(HardStop, ARecordedMotionIsFinishedBySigterm) {
  const auto isRecording = [&] {
    std::error_code none;
    return fs::file_size(folder.path() / "o.part.lsession", none) > 5000 && !none;
  };
  const FaultyEnd end =
      run({"record", "o.lsession", "--virtual", "--decomposition", "b.lorica"}, Fault::kTerminate, isRecording);
  EXPECT_EQ(end.exitCode, 0) << end.err;
  const Result<SessionFile> session = readSession(folder.path() / "o.lsession");
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_TRUE(session->finished);
  EXPECT_FALSE(fs::exists(folder.path() / "o.part.lsession"));
  EXPECT_EQ(filesLeft(folder.path() / "tmp"), 0u) << "OpenNI2's folder of drivers";
}

TEST_F(HardStop, AFoundRecordingIsKeptUnderANewName) {
  const std::string found = "what a killed program recorded";
  folder.write("o.part.lsession", found);
  const FaultyEnd end =
      run({"record", "o.lsession", "wave", "--frames", "3", "--decomposition", "b.lorica"}, Fault::kNone);
  ASSERT_EQ(end.exitCode, 0) << end.err;
  EXPECT_NE(end.err.find("it is kept as o.found-1.lsession"), std::string::npos) << end.err;
  EXPECT_EQ(readFile(folder.path() / "o.found-1.lsession").value(), found);
  EXPECT_TRUE(readSession(folder.path() / "o.lsession").ok());

  folder.write("r.part.oni", found);
  folder.write("r.part.csv", found);
  const FaultyEnd depth = run({"record", "r.oni", "--virtual", "--frames", "3"}, Fault::kNone);
  ASSERT_EQ(depth.exitCode, 0) << depth.err;
  EXPECT_EQ(readFile(folder.path() / "r.found-1.oni").value(), found);
  EXPECT_EQ(readFile(folder.path() / "r.found-1.csv").value(), found);
}

TEST(AtHardStop, RunsTheTasksThatAreLeftNewestFirst) {
  EXPECT_EXIT(
      {
        const AtHardStop first([] { (void)fputs("first", stderr); });
        {
          const AtHardStop over([] { (void)fputs("over", stderr); });
        }
        const AtHardStop second([] { (void)fputs("second ", stderr); });
        runHardStop();
        _Exit(7);
      },
      testing::ExitedWithCode(7), "^second first$");
}

TEST(AtHardStop, RunsATaskThatComesTooLateAtOnce) {
  EXPECT_EXIT(
      {
        runHardStop();
        const AtHardStop late([] {
          (void)fputs("late", stderr);
          _Exit(7);
        });
      },
      testing::ExitedWithCode(7), "^late$");
}

}  // namespace
}  // namespace lorica::test
