#include "tests/apps/run_command.h"

#include "tests/support/shared_by_tests.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <sstream>

namespace lorica::test {
namespace {

std::string contentOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

/// Runs between fork and exec: only async-signal-safe calls, and setenv, because the parent has one thread.
[[noreturn]] void becomeLorica(char* const* arguments, const CommandSurroundings& surroundings, const char* cache,
                               const char* out, const char* err) {
  const std::filesystem::path& recordings = surroundings.recordings;
  setenv("LORICA_RECORDINGS", recordings.empty() ? recordingsFolder().c_str() : recordings.c_str(), 1);
  setenv("XDG_CACHE_HOME", cache, 1);
  setenv("XDG_CONFIG_HOME", "/dev/null", 1);  // the settings of whoever runs the tests stay as they are
  unsetenv("LORICA_VIRTUAL");
  if (!surroundings.virtualCamera.empty()) setenv("LORICA_VIRTUAL", surroundings.virtualCamera.c_str(), 1);
  unsetenv("DISPLAY");
  if (!surroundings.display.empty()) setenv("DISPLAY", surroundings.display.c_str(), 1);
  if (!surroundings.libraries.empty()) setenv("LD_LIBRARY_PATH", surroundings.libraries.c_str(), 1);
  unsetenv("WAYLAND_DISPLAY");
  const int outFile = open(out, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int errFile = open(err, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int nothing = open("/dev/null", O_RDONLY);
  if (outFile < 0 || errFile < 0 || nothing < 0 || chdir(surroundings.folder.c_str()) != 0) _exit(126);
  dup2(nothing, STDIN_FILENO);
  dup2(outFile, STDOUT_FILENO);
  dup2(errFile, STDERR_FILENO);
  // A shell that runs tests in the background ignores SIGINT, which children inherit.
  std::signal(SIGINT, SIG_DFL);
  execv(arguments[0], arguments);
  _exit(127);
}

/// Sends SIGINT when it is time, unless the command ends before.
void interrupt(pid_t child, const CommandSurroundings& surroundings, const std::filesystem::path& err) {
  siginfo_t end{};
  while (waitid(P_PID, static_cast<id_t>(child), &end, WEXITED | WNOHANG | WNOWAIT) == 0 && end.si_pid == 0) {
    if (surroundings.interruptWhen({child, contentOf(err)})) {
      kill(child, SIGINT);
      return;
    }
    usleep(2000);
  }
}

}  // namespace

bool hasWorked(const RunningCommand& command, double seconds) {
  clockid_t clock{};
  timespec used{};
  if (clock_getcpuclockid(command.process, &clock) != 0 || clock_gettime(clock, &used) != 0) return false;
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec) >= seconds;
}

nlohmann::json CommandResult::json() const {
  nlohmann::json parsed = nlohmann::json::parse(out, nullptr, false);
  EXPECT_FALSE(parsed.is_discarded()) << "exit code " << exitCode << "\nout: " << out << "\nerr: " << err;
  // Always return an object, so that a missing key fails the test instead of ending the program.
  return parsed.is_object() ? parsed : nlohmann::json::object();
}

CommandResult runLorica(const std::vector<std::string>& arguments, const CommandSurroundings& surroundings) {
  const TemporaryFolder streams;
  const std::filesystem::path out = streams.path() / "out";
  const std::filesystem::path err = streams.path() / "err";
  std::vector<std::string> words = {built("lorica")};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);

  // What one test computed serves the others, whatever order they run in: results are the same bits on every run.
  const std::filesystem::path cache = surroundings.cache.empty() ? sharedByTests("cache") : surroundings.cache;
  const pid_t child = fork();
  if (child == 0) becomeLorica(pointers.data(), surroundings, cache.c_str(), out.c_str(), err.c_str());
  if (surroundings.interruptWhen) interrupt(child, surroundings, err);
  int status = 0;
  waitpid(child, &status, 0);
  CommandResult result;
  result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = contentOf(out);
  result.err = contentOf(err);
  return result;
}

nlohmann::json jsonOf(std::vector<std::string> arguments, const CommandSurroundings& surroundings) {
  arguments.insert(arguments.end(), {"--json", "-"});
  const CommandResult result = runLorica(arguments, surroundings);
  EXPECT_EQ(result.exitCode, 0) << result.err;
  return result.json();
}

std::filesystem::path mannequinBody(const TemporaryFolder& folder, int parts) {
  std::filesystem::path body = folder.path() / "body.lorica";
  const std::filesystem::path shared = sharedByTests("cache") / ("mannequin_" + std::to_string(parts) + ".lorica");
  if (!exists(shared)) {
    // Renamed when it is whole: another test may make it at the same time.
    const CommandResult made =
        runLorica({"decompose", "mannequin", "--parts", std::to_string(parts), "--keyframes", "2", "-o", body});
    EXPECT_EQ(made.exitCode, 0) << made.err;
    const std::filesystem::path copy = shared.string() + std::to_string(getpid());
    copy_file(body, copy);
    rename(copy, shared);
    return body;
  }
  copy_file(shared, body, std::filesystem::copy_options::overwrite_existing);
  return body;
}

std::vector<std::string> filesIn(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace lorica::test
