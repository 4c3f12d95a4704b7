#include "tests/apps/faults/faulty_run.h"

#include "geometry/sanitizer.h"
#include "tests/support/datasets.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/capability.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <thread>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// @return 0 if the fault is no signal
int signalOf(Fault fault) {
  switch (fault) {
    case Fault::kInterrupt:
      return SIGINT;
    case Fault::kTerminate:
    case Fault::kServerHangs:
      return SIGTERM;
    case Fault::kHangUp:
      return SIGHUP;
    case Fault::kKill:
      return SIGKILL;
    default:
      return 0;
  }
}

const char* shimOf(Fault fault) {
  switch (fault) {
    case Fault::kServerAway:
      return "away";
    case Fault::kServerHangs:
      return "hangs";
    case Fault::kClockWrong:
      return "clock";
    default:
      return "";
  }
}

/// Runs between fork and exec: only async-signal-safe calls, and setenv, because the parent has one thread.
[[noreturn]] void become(char* const* arguments, const FaultyRun& run, const std::string& temporary,
                         const std::string& library, const std::array<int, 2>& out, const std::array<int, 2>& err) {
  setenv("LORICA_RECORDINGS", recordingsFolder().c_str(), 1);
  setenv("XDG_CACHE_HOME", run.cache.c_str(), 1);
  setenv("TMPDIR", temporary.c_str(), 1);
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  unsetenv("LORICA_VIRTUAL");
  for (const auto& [name, value] : run.environment) setenv(name.c_str(), value.c_str(), 1);
  if (const char* shim = shimOf(run.fault); *shim != '\0') {
    setenv("LORICA_SHIM", shim, 1);
    setenv("LORICA_SHIM_FOLDER", run.folder.c_str(), 1);
    setenv("LD_PRELOAD", library.c_str(), 1);
  }
  dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
  dup2(out[1], STDOUT_FILENO);
  dup2(err[1], STDERR_FILENO);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(number, SIG_DFL);
  if (chdir(run.folder.c_str()) != 0) _exit(126);
  if (run.fault == Fault::kDiskFull && access(kFiller, F_OK) != 0) {
    const rlimit limit = {64, 64};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) _exit(126);
  }
  // Permissions do not hold for root unless this capability is gone, which takes effect with exec.
  if (run.fault == Fault::kReadOnly && geteuid() == 0) {
    if (prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, 0, 0, 0) != 0) _exit(126);
  }
  if (run.fault == Fault::kOutputClosed) close(STDOUT_FILENO);
  if (run.fault == Fault::kErrorsClosed) close(STDERR_FILENO);
  execv(arguments[0], arguments);
  _exit(127);
}

std::string readAll(int descriptor) {
  std::string text;
  std::array<char, 4096> buffer{};
  for (ssize_t got = 0; (got = read(descriptor, buffer.data(), buffer.size())) > 0;) {
    text.append(buffer.data(), static_cast<std::size_t>(got));
  }
  close(descriptor);
  return text;
}

/// Sends the signal when it is time. @return when it was sent
Clock::time_point sendSignal(pid_t child, const FaultyRun& run, int number) {
  const Clock::time_point begin = Clock::now();
  const auto due = [&] { return run.ready ? run.ready() : secondsSince(begin) > 0.25; };
  const auto ended = [&] {
    siginfo_t end{};
    return waitid(P_PID, static_cast<id_t>(child), &end, WEXITED | WNOHANG | WNOWAIT) != 0 || end.si_pid != 0;
  };
  while (!due() && !ended()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const Clock::time_point sent = Clock::now();
  kill(child, number);
  // `bake` waits for its items after the first.
  while (run.fault == Fault::kServerHangs && !ended() && secondsSince(sent) < 2.0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (run.fault == Fault::kServerHangs && !ended()) kill(child, number);
  return sent;
}

}  // namespace

const char* nameOf(Fault fault) {
  constexpr std::array<const char*, 12> kNames = {"nothing",          "SIGINT",      "SIGTERM",       "SIGHUP",
                                                  "kill -9",          "disk full",   "output closed", "errors closed",
                                                  "folder read-only", "server away", "server hangs",  "clock wrong"};
  return kNames[static_cast<std::size_t>(fault)];
}

bool hasShim() {
  return !kReservesAddresses && fs::exists(built("lib/liblorica_fault_shim.so"));
}

std::optional<bool> onDiskOfItsOwn(const fs::path& folder, int megabytes, const std::function<void()>& work) {
  constexpr int kNoDisk = 77;
  std::cout.flush();
  const pid_t child = fork();
  if (child == 0) {
    const std::string user = "0 " + std::to_string(getuid()) + " 1", group = "0 " + std::to_string(getgid()) + " 1";
    const std::string size = "size=" + std::to_string(megabytes) + "m";
    bool made = unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0;
    if (made) {
      std::ofstream("/proc/self/setgroups") << "deny";
      std::ofstream("/proc/self/uid_map") << user;
      std::ofstream("/proc/self/gid_map") << group;
      made = mount("lorica", folder.c_str(), "tmpfs", 0, size.c_str()) == 0;
    }
    if (!made) {
      std::cout << "the kernel makes no disk for this test (" << std::strerror(errno)
                << "): a limit of file sizes stands for a full one" << std::endl;
      _exit(kNoDisk);
    }
    work();
    std::cout.flush();
    _exit(testing::Test::HasFailure() ? 1 : 0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNoDisk) return std::nullopt;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void fillDisk(const fs::path& folder) {
  const int file = open((folder / kFiller).c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  const std::string bytes(1 << 20, '.');
  for (std::size_t size = bytes.size(); size > 0; size /= 2) {
    while (write(file, bytes.data(), size) > 0) {
    }
  }
  close(file);
}

FaultyEnd runWithFault(const FaultyRun& run) {
  const TemporaryFolder elsewhere;  // without permission to write to the working folder
  const std::string temporary = run.fault == Fault::kReadOnly ? elsewhere.path() : run.folder / "tmp";
  if (run.fault != Fault::kReadOnly) fs::create_directories(temporary);
  std::vector<std::string> words = {run.program.empty() ? built("lorica").string() : run.program};
  const std::string library = built("lib/liblorica_fault_shim.so");
  words.insert(words.end(), run.arguments.begin(), run.arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::array<int, 2> out{}, err{};
  if (pipe2(out.data(), O_CLOEXEC) != 0 || pipe2(err.data(), O_CLOEXEC) != 0) ADD_FAILURE() << "no pipes";
  if (run.fault == Fault::kReadOnly) fs::permissions(run.folder, fs::perms::owner_read | fs::perms::owner_exec);
  const pid_t child = fork();
  if (child == 0) become(pointers.data(), run, temporary, library, out, err);
  close(out[1]);
  close(err[1]);
  Clock::time_point sent = Clock::now();
  if (const int number = signalOf(run.fault); number != 0) sent = sendSignal(child, run, number);
  FaultyEnd end;
  // A few kilobytes, less than a pipe holds.
  int status = 0;
  waitpid(child, &status, 0);
  end.secondsAfterSignal = secondsSince(sent);
  end.out = readAll(out[0]);
  end.err = readAll(err[0]);
  end.bySignal = WIFSIGNALED(status);
  end.exitCode = end.bySignal ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  fs::permissions(run.folder, fs::perms::owner_all);
  return end;
}

}  // namespace lorica::test
