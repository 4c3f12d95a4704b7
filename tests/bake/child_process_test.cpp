#include "bake/child_process.h"

#include "geometry/files.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

namespace lorica::test {
namespace {

ProcessOrder shell(const TemporaryFolder& folder, const std::string& script) {
  return {"/bin/sh", {"-c", script}, {{"WORD", "said"}}, folder.path() / "log", 0};
}

ProcessEnd endOf(ChildProcess& process) {
  std::optional<ProcessEnd> end;
  while (!(end = process.ended())) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return *end;
}

TEST(ChildProcess, SaysHowItEndedAndWhatItPrinted) {
  const TemporaryFolder folder;
  Result<ChildProcess> process = ChildProcess::start(shell(folder, "echo $WORD; echo too >&2; exit 3"));
  ASSERT_TRUE(process.ok());
  const ProcessEnd end = endOf(*process);
  EXPECT_EQ(end.exitStatus, 3);
  EXPECT_EQ(end.signal, 0);
  EXPECT_GT(end.peakMemory, 100'000u);
  EXPECT_EQ(*readFile(folder.path() / "log"), "said\ntoo\n");
}

TEST(ChildProcess, ACrashIsASignal) {
  const TemporaryFolder folder;
  Result<ChildProcess> process = ChildProcess::start(shell(folder, "kill -SEGV $$"));
  ASSERT_TRUE(process.ok());
  EXPECT_EQ(endOf(*process).signal, SIGSEGV);
}

TEST(ChildProcess, MemoryIsLimited) {
  const TemporaryFolder folder;
  // A string that doubles until it is larger than the limit.
  ProcessOrder order = shell(folder, "x=aaaaaaaaaaaaaaaa; while [ ${#x} -lt 400000000 ]; do x=$x$x; done");
  order.memoryBytes = 50'000'000;
  Result<ChildProcess> process = ChildProcess::start(order);
  ASSERT_TRUE(process.ok());
  const ProcessEnd end = endOf(*process);
  EXPECT_TRUE(end.exitStatus != 0 || end.signal != 0);
  EXPECT_LT(end.peakMemory, 60'000'000u);
}

TEST(ChildProcess, AMissingProgramIsAnError) {
  const TemporaryFolder folder;
  const Result<ChildProcess> process = ChildProcess::start({"/no/such/program", {}, {}, folder.path() / "log", 0});
  ASSERT_FALSE(process.ok());
  EXPECT_EQ(process.error().message, "/no/such/program: cannot be started: No such file or directory");
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a process was left behind";
}

TEST(ChildProcess, EndsWithItsOwnerAndItsOwnChildrenToo) {
  const TemporaryFolder folder;
  { const Result<ChildProcess> process = ChildProcess::start(shell(folder, "sleep 100 & echo $!; wait")); }
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a process was left behind";
}

TEST(ChildProcess, EndsWhenThisProcessIsKilled) {
  const TemporaryFolder folder;
  const pid_t owner = fork();
  if (owner == 0) {
    const Result<ChildProcess> process = ChildProcess::start(shell(folder, "echo $$; exec sleep 100"));
    while (true) ::pause();
  }
  std::string said;
  while (!said.ends_with('\n')) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    said = readFile(folder.path() / "log").ok() ? *readFile(folder.path() / "log") : "";
  }
  const pid_t child = std::stoi(said);
  ::kill(owner, SIGKILL);
  ::waitpid(owner, nullptr, 0);
  const auto gone = [&] {
    const Result<std::string> stat = readFile("/proc/" + std::to_string(child) + "/stat", NamedBy::kFile);
    return !stat || stat->find(") Z ") != std::string::npos;
  };
  while (!gone()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

}  // namespace
}  // namespace lorica::test
