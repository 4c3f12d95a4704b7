#include "export/bake/child_process.h"

#include "geometry/errors.h"
#include "geometry/sanitizer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <system_error>
#include <thread>

extern char** environ;

namespace lorica {
namespace {

/// Runs between fork and exec: only async-signal-safe calls. On failure errno goes into the pipe.
[[noreturn]] void become(const char* program, char* const* arguments, char* const* environment, const char* output,
                         const rlimit& memory, pid_t parent, int failure) {
  for (int number = 1; number < NSIG; ++number) std::signal(number, SIG_DFL);  // those of the kernel cannot be set
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int in = ::open("/dev/null", O_RDONLY);
  const int out = ::open(output, O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW, 0666);
  const rlimit noCore = {0, 0};
  const bool ready = in >= 0 && out >= 0 && ::dup2(in, STDIN_FILENO) >= 0 && ::dup2(out, STDOUT_FILENO) >= 0 &&
                     ::dup2(out, STDERR_FILENO) >= 0 && ::setpgid(0, 0) == 0 &&
                     ::prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && ::setrlimit(RLIMIT_CORE, &noCore) == 0 &&
                     (memory.rlim_cur == 0 || kReservesAddresses || ::setrlimit(RLIMIT_DATA, &memory) == 0);
  if (ready && ::getppid() == parent) ::execve(program, arguments, environment);
  const int error = errno;
  [[maybe_unused]] const ssize_t written = ::write(failure, &error, sizeof(error));
  ::_exit(127);
}

std::vector<char*> pointersTo(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// The environment of this process with some variables set.
std::vector<std::string> environmentWith(const std::vector<std::pair<std::string, std::string>>& set) {
  std::vector<std::string> all;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string text = *variable;
    bool replaced = false;
    for (const auto& [name, value] : set) {
      replaced = replaced || (text.starts_with(name) && text.substr(name.size()).starts_with('='));
    }
    if (!replaced) all.push_back(text);
  }
  for (const auto& [name, value] : set) all.push_back(fmt::format("{}={}", name, value));
  return all;
}

}  // namespace

Result<ProcessEnd> runProgram(const ProcessOrder& order, const std::function<bool()>& goOn) {
  const auto failed = [&order](int error) {
    return unreadable("{}: cannot be started: {}", order.program.string(), std::generic_category().message(error));
  };
  std::vector<std::string> words = {order.program.string()};
  words.insert(words.end(), order.arguments.begin(), order.arguments.end());
  std::vector<std::string> variables = environmentWith(order.environment);
  const std::vector<char*> arguments = pointersTo(words);
  const std::vector<char*> environment = pointersTo(variables);
  const rlimit memory = {order.memoryBytes, order.memoryBytes};
  std::array<int, 2> ends = {-1, -1};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return failed(errno);
  const pid_t parent = ::getpid();
  const pid_t process = ::fork();
  if (process == 0) {
    become(order.program.c_str(), arguments.data(), environment.data(), order.output.c_str(), memory, parent, ends[1]);
  }
  int error = process < 0 ? errno : 0;
  ::close(ends[1]);
  // The pipe is closed by exec, so nothing is read if that succeeded.
  if (error == 0 && ::read(ends[0], &error, sizeof(error)) == sizeof(error)) ::waitpid(process, nullptr, 0);
  ::close(ends[0]);
  if (error != 0) return failed(error);

  ProcessEnd end;
  int status = 0;
  rusage used = {};
  for (pid_t got = 0; (got = ::wait4(process, &status, end.stopped ? 0 : WNOHANG, &used)) != process;) {
    if (got < 0 && errno != EINTR) return failed(errno);
    if (!end.stopped && !goOn()) {
      end.stopped = true;
      ::killpg(process, SIGKILL);
      ::kill(process, SIGKILL);  // if it has not made its group yet
    } else if (!end.stopped) {
      std::this_thread::sleep_for(std::chrono::milliseconds(4));
    }
  }
  const auto seconds = [](const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); };
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  if (WIFEXITED(status)) end.exitStatus = WEXITSTATUS(status);
  end.cpuSeconds = seconds(used.ru_utime) + seconds(used.ru_stime);
  end.peakMemory = static_cast<std::uint64_t>(used.ru_maxrss) * 1024;
  return end;
}

}  // namespace lorica
