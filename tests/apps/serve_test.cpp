#include "geometry/files.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>
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

/// The client that needs nothing but Python's own library gets frames of a session that is served.
TEST(Serve, TheSampleClientWatches) {
  if (std::system("python3 --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "python3 is missing";
  const TemporaryFolder folder;
  const std::filesystem::path log = folder.path() / "log";
  int status = -1;
  CommandSurroundings surroundings;
  surroundings.interruptWhen = [&](const RunningCommand& command) {
    const std::string address = addressIn(command.err);
    if (address.empty()) return false;
    const std::string sample = sourceFile("samples/watch_session.py");
    status =
        std::system(("timeout 120 python3 '" + sample + "' " + address + " 30 >'" + log.string() + "' 2>&1").c_str());
    return true;
  };
  const CommandResult served = runLorica({"serve", "punch_and_kick"}, surroundings);
  EXPECT_EQ(served.exitCode, 0) << served.err;
  ASSERT_NE(status, -1) << "nothing was served: " << served.err;
  const std::string text = valueOf(readFile(log));
  EXPECT_EQ(status, 0) << text;

  std::istringstream lines(text);
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

}  // namespace
}  // namespace lorica::test
