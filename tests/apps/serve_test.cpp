#include "geometry/files.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
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

/// What a sample program says of 30 frames of a session that is served.
std::string watchedBy(const std::string& sample) {
  const TemporaryFolder folder;
  const std::filesystem::path log = folder.path() / "log";
  int status = -1;
  CommandSurroundings surroundings;
  surroundings.interruptWhen = [&](const RunningCommand& command) {
    const std::string address = addressIn(command.err);
    if (address.empty()) return false;
    status = std::system(("timeout 120 " + sample + " " + address + " 30 >'" + log.string() + "' 2>&1").c_str());
    return true;
  };
  const CommandResult served = runLorica({"serve", "punch_and_kick"}, surroundings);
  EXPECT_EQ(served.exitCode, 0) << served.err;
  EXPECT_EQ(status, 0) << served.err;
  return valueOf(readFile(log));
}

/// The client that needs nothing but Python's own library.
TEST(Serve, TheSampleInPythonWatches) {
  if (std::system("python3 --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "python3 is missing";
  std::istringstream lines(watchedBy("python3 '" + std::string(sourceFile("samples/watch_session.py")) + "'"));
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_EQ(line, "hello: punch_and_kick");
  int frames = 0;
  while (std::getline(lines, line)) {
    double seconds = -1.0, x = 0.0, y = 0.0, z = 0.0;
    int bytes = 0, avatar = -1;
    ASSERT_EQ(
        std::sscanf(line.c_str(), "%lf s, %d bytes: avatar %d at %lf %lf %lf", &seconds, &bytes, &avatar, &x, &y, &z),
        6)
        << line;
    EXPECT_GE(seconds, 0.0);
    EXPECT_EQ(avatar, 0);
    EXPECT_GT(bytes, 32 + 20 * 20) << line;
    ++frames;
  }
  EXPECT_EQ(frames, 30);
}

/// The client that needs nothing but Boost.
TEST(Serve, TheSampleInCppWatches) {
  std::istringstream lines(watchedBy("'" + std::string(built("lorica_watch_session")) + "'"));
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

/// Options that would have no effect.
TEST(Serve, RefusesWhatDoesNotGoTogether) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> rows = {
      {{"serve", "walk", "--virtual"}, "walk: expected a motion or who is followed, not both"},
      {{"serve", "walk", "--certificate", "c.pem", "--key", "k.pem"}, "--certificate requires --lan"},
      {{"serve", "walk", "--certificate", "c.pem", "--lan"}, "--certificate requires --key"},
      {{"play", "walk", "--lan"}, "--lan requires --serve"},
      {{"live", "--virtual", "--port", "8500"}, "--port requires --serve"},
      {{"demo", "--recordings", "here"}, "--recordings requires --serve"}};
  for (const auto& [arguments, sentence] : rows) {
    const CommandResult refused = runLorica(arguments);
    EXPECT_EQ(refused.exitCode, 2) << sentence;
    EXPECT_NE(refused.err.find(sentence), std::string::npos) << refused.err;
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
