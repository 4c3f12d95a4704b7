#include "geometry/files.h"
#include "geometry/hard_stop.h"
#include "session/recording/session_file.h"
#include "tests/apps/faults/faulty_run.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

/// Runs a line of the shell, where $LORICA is the command. @return its exit status
int shell(const TemporaryFolder& folder, const std::string& line) {
  const std::string command = "cd '" + folder.path().string() + "' && XDG_CACHE_HOME=/dev/null LORICA='" +
                              built("lorica").string() + "'; " + line;
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

FaultyEnd run(const TemporaryFolder& folder, std::vector<std::string> arguments, Fault fault = Fault::kNone) {
  return runWithFault({std::move(arguments), folder.path(), folder.path() / "cache", fault});
}

const std::vector<std::string>& commands() {
  static const std::vector<std::string> all = {"demo",   "decompose", "score", "play",    "live",
                                               "record", "replay",    "info",  "convert", "snapshot"};
  return all;
}

TEST(Output, HelpThatCannotBeWrittenIsAnError) {
  const TemporaryFolder folder;
  EXPECT_EQ(shell(folder, "\"$LORICA\" --help > /dev/full 2> err"), 2);
  EXPECT_EQ(shell(folder, "grep -q 'standard output: could not write the help: No space' err"), 0);
  EXPECT_EQ(shell(folder, "\"$LORICA\" --version > /dev/full 2> err"), 2);
  for (const std::string& command : commands()) {
    EXPECT_EQ(shell(folder, "\"$LORICA\" " + command + " --help > /dev/full 2> /dev/null"), 2) << command;
    EXPECT_EQ(shell(folder, "\"$LORICA\" " + command + " --help > /dev/null"), 0) << command;
  }
}

TEST(Output, MessagesThatCannotBeWrittenDoNotAbort) {
  const TemporaryFolder folder;
  for (const std::string& command : commands()) {
    EXPECT_EQ(shell(folder, "\"$LORICA\" " + command + " --no-such-option 2> /dev/full"), 2) << command;
    EXPECT_EQ(shell(folder, "\"$LORICA\" " + command + " --no-such-option 2>&-"), 2) << command;
  }
  EXPECT_EQ(shell(folder, "\"$LORICA\" info missing.off > /dev/full 2> /dev/full"), 2);
  EXPECT_EQ(shell(folder, "\"$LORICA\" info missing.off >&- 2>&- <&-"), 2);
  EXPECT_EQ(
      shell(folder,
            "mkfifo gate; (read go < gate; \"$LORICA\" info mannequin; echo $? > status) | (exec <&-; echo go > gate)"),
      0);
  EXPECT_EQ(shell(folder, "until [ -s status ]; do sleep 0.02; done; test \"$(cat status)\" = 2"), 0)
      << "a closed pipe is an error, no signal";
}

TEST(Output, AFileNeverTakesThePlaceOfAMissingStream) {
  const TemporaryFolder folder;
  // The JSON would be opened as descriptor 1 or 2, and the report or a warning would be written into it.
  const FaultyEnd end = run(folder, {"info", "mannequin", "--json", "o.json"}, Fault::kErrorsClosed);
  EXPECT_EQ(end.exitCode, 0);
  (void)run(folder, {"info", "mannequin", "--json", "p.json"}, Fault::kOutputClosed);
  for (const char* name : {"o.json", "p.json"}) {
    EXPECT_TRUE(nlohmann::json::accept(std::ifstream(folder.path() / name))) << name;
  }
}

TEST(Output, LongNamesAreShortenedAndControlCharactersEscaped) {
  const TemporaryFolder folder;
  const FaultyEnd end = run(folder, {"info", std::string(100'000, 'x') + "\x1b[31m.off"});
  EXPECT_EQ(end.exitCode, 2);
  EXPECT_LT(end.err.size(), 1200u);
  EXPECT_NE(end.err.find("bytes) ..."), std::string::npos) << end.err;
  const FaultyEnd option = run(folder, {"info", "--" + std::string(100'000, 'y')});
  EXPECT_EQ(option.exitCode, 2);
  EXPECT_LT(option.err.size(), 1200u);
  const FaultyEnd colour = run(folder, {"info", "a\x1b[31m\n\xff\u00e9.off"});
  EXPECT_NE(colour.err.find("a\\x1b[31m\\x0a\\xff\u00e9.off"), std::string::npos) << colour.err;

  folder.write("long.json", R"({"format": "lorica scene 1", ")" + std::string(100'000, 'k') + R"(": 1})");
  const FaultyEnd key =
      run(folder, {"play", "wave", "--frames", "1", "--scene", "long.json", "--decomposition", "n.lorica"});
  EXPECT_EQ(key.exitCode, 2);
  EXPECT_LT(key.err.size(), 1200u);
}

TEST(Output, AVolumeBeyondAllNumbersIsSaidInWords) {
  const TemporaryFolder folder;
  folder.write("huge.off", "OFF\n4 4 0\n0 0 0\n1e200 0 0\n0 1e200 0\n0 0 1e200\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  const FaultyEnd end = run(folder, {"info", "huge.off"});
  EXPECT_EQ(end.exitCode, 0) << end.err;
  EXPECT_EQ(end.out.find("nan"), std::string::npos) << end.out;
  EXPECT_EQ(end.out.find("builds a closed body"), std::string::npos) << end.out;
  EXPECT_NE(end.out.find("too large to be measured"), std::string::npos) << end.out;
}

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
