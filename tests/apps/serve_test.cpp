#include "geometry/files.h"
#include "geometry/sanitizer.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace lorica::test {
namespace {

/// Where an output says that one can watch: "127.0.0.1:8420"; empty = it does not say it yet.
std::string addressIn(const std::string& output) {
  const std::string before = "Watch at http://";
  const std::size_t at = output.find(before);
  const std::size_t end = at == std::string::npos ? at : output.find("/\n", at);
  return end == std::string::npos ? "" : output.substr(at + before.size(), end - at - before.size());
}

/// The client that needs nothing but Boost watches 30 frames of a session that is served.
TEST(Serve, TheSampleInCppWatches) {
  const TemporaryFolder folder;
  const std::filesystem::path log = folder.path() / "log";
  int status = -1;
  CommandSurroundings surroundings;
  surroundings.interruptWhen = [&](const RunningCommand& command) {
    const std::string address = addressIn(command.err);
    if (address.empty()) return false;
    const std::string sample = built("lorica_watch_session");
    status = std::system(("timeout 120 '" + sample + "' " + address + " 30 >'" + log.string() + "' 2>&1").c_str());
    return true;
  };
  const CommandResult served = runLorica({"serve", "punch_and_kick"}, surroundings);
  EXPECT_EQ(served.exitCode, 0) << served.err;
  EXPECT_EQ(status, 0) << served.err;
  std::istringstream lines(valueOf(readFile(log)));
  int frames = 0;
  for (std::string line; std::getline(lines, line);) {
    double seconds = -1.0;
    int some = 0, bones = 0, props = -1, bytes = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf s: %d frames, %d bones, %d props, %d bytes", &seconds, &some, &bones,
                          &props, &bytes),
              5)
        << line;
    EXPECT_GE(seconds, 0.0);
    EXPECT_GT(bones, 20 * some) << line;
    EXPECT_GE(props, 0);
    EXPECT_GT(bytes, 20 * bones) << line;
    frames += some;
  }
  EXPECT_EQ(frames, 30);
}

/// No guest's file may end the session of all by the limit that a command has which nobody watches.
TEST(Serve, APageHasNoLimitOfMemoryButTheUsers) {
  if (kReservesAddresses) GTEST_SKIP() << "no limit of memory holds under this sanitizer";
  const auto limitOf = [](const std::string& process) {
    std::ifstream limits("/proc/" + process + "/limits");
    std::string line;
    while (std::getline(limits, line) && !line.starts_with("Max data size")) {
    }
    return line;
  };
  for (const bool given : {false, true}) {
    std::string line;
    CommandSurroundings surroundings;
    surroundings.interruptWhen = [&](const RunningCommand& command) {
      if (addressIn(command.err).empty()) return false;
      line = limitOf(std::to_string(command.process));
      return true;
    };
    std::vector<std::string> arguments = {"serve", "walk"};
    if (given) arguments.insert(arguments.end(), {"--memory", "3G"});
    (void)runLorica(arguments, surroundings);  // how it ends depends on how far it is
    EXPECT_FALSE(line.empty());
    EXPECT_EQ(line == limitOf("self"), !given) << line;
  }
}

/// As many frames as are asked for, then the report: of a motion, of the demo, and of a virtual camera in a scene.
TEST(Serve, EndsAfterItsFrames) {
  for (const std::vector<std::string>& what :
       {std::vector<std::string>{"serve", "walk"}, {"serve"}, {"serve", "--virtual", "--scene", "bowling"}}) {
    std::vector<std::string> arguments = what;
    arguments.insert(arguments.end(), {"--frames", "5", "--json", "-"});
    const CommandResult served = runLorica(arguments);
    ASSERT_EQ(served.exitCode, 0) << served.err;
    EXPECT_EQ(served.json()["frames"], 5);
  }
}

/// A motion that cannot be played is said before anybody is sent to a page.
TEST(Serve, SaysWhatIsWrongInsteadOfALink) {
  const TemporaryFolder folder;
  const std::string damaged = folder.write("damaged.csv", "time,user\n1,nobody\n");
  for (const std::string& motion : {std::string("no_such_motion"), damaged}) {
    const CommandResult served = runLorica({"serve", motion});
    EXPECT_NE(served.exitCode, 0);
    EXPECT_NE(served.err.find(motion), std::string::npos) << served.err;
    EXPECT_EQ(addressIn(served.err), "") << served.err;
  }
}

/// Recordings go into a folder that can be made.
TEST(Serve, AFolderForRecordingsIsCheckedFirst) {
  const TemporaryFolder folder;
  const std::string file = folder.write("file", "");
  const CommandResult served = runLorica({"serve", "walk", "--recordings", file + "/in"});
  EXPECT_NE(served.exitCode, 0);
  EXPECT_NE(served.err.find("--recordings: " + file), std::string::npos) << served.err;
  EXPECT_EQ(addressIn(served.err), "");
}

}  // namespace
}  // namespace lorica::test
