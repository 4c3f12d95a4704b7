#include "tests/bench/measure.h"

#include "geometry/clock.h"

#include <fmt/format.h>
#include <hwy/targets.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <ctime>
#include <fstream>
#include <numeric>

#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

namespace lorica::bench {

namespace {

void writeAll(int file, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = ::write(file, text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return;  // the parent detects the incomplete answer
    done += static_cast<std::size_t>(count);
  }
}

std::string readAll(int file) {
  std::string text;
  char buffer[4096];
  while (true) {
    const ssize_t count = ::read(file, buffer, sizeof(buffer));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(buffer, static_cast<std::size_t>(count));
  }
}

double secondsOf(clockid_t clock) {
  timespec time{};
  ::clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// A value of this process from /proc; 0 if it is missing.
double kibibytesOf(const std::string& name) {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    double kibibytes = 0.0;
    if (word == name && status >> kibibytes) return kibibytes;
  }
  return 0.0;
}

}  // namespace

Result<std::string> inOwnProcess(const std::function<Result<std::string>()>& work) {
  int ends[2];
  if (::pipe(ends) != 0) {
    return Error{ErrorCode::kUnsupported, fmt::format("cannot create a pipe: {}", std::strerror(errno))};
  }
  std::fflush(nullptr);  // otherwise the child would write buffered output a second time
  const pid_t child = ::fork();
  if (child < 0) {
    ::close(ends[0]);
    ::close(ends[1]);
    return Error{ErrorCode::kUnsupported, fmt::format("cannot start a process: {}", std::strerror(errno))};
  }
  if (child == 0) {
    ::close(ends[0]);
    const Result<std::string> answer = work();
    writeAll(ends[1], answer ? "+" + *answer : "-" + answer.error().message);
    ::_exit(0);
  }
  ::close(ends[1]);
  const std::string answer = readAll(ends[0]);
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status)) {
    return Error{ErrorCode::kUnsupported, fmt::format("the process was terminated by signal {} ({})", WTERMSIG(status),
                                                      ::strsignal(WTERMSIG(status)))};
  }
  if (answer.empty()) return Error{ErrorCode::kUnsupported, "the process ended without an answer"};
  if (answer[0] == '-') return Error{ErrorCode::kInvalidArgument, answer.substr(1)};
  return answer.substr(1);
}

double peakMemoryMiB() {
  return kibibytesOf("VmHWM:") / 1024.0;
}

double residentBytes() {
  ::malloc_trim(0);  // return freed memory to the system
  return kibibytesOf("VmRSS:") * 1024.0;
}

double cpuSeconds() {
  return secondsOf(CLOCK_PROCESS_CPUTIME_ID);
}

double threadSeconds() {
  return secondsOf(CLOCK_THREAD_CPUTIME_ID);
}

Result<Timed> timeDecompose(const TriMesh& mesh, PoseView keyframes, const DecomposeSettings& settings, int repeats) {
  Timed timed;
  std::vector<double> wall;
  std::vector<double> cpu;
  for (int i = 0; i < repeats; ++i) {
    const double wallBefore = now();
    const double cpuBefore = cpuSeconds();
    Result<Decomposition> made = decompose(mesh, keyframes, settings);
    cpu.push_back(cpuSeconds() - cpuBefore);
    wall.push_back(now() - wallBefore);
    if (!made) return made.error();
    timed.decomposition = std::move(*made);
  }
  timed.seconds = medianOf(wall);
  timed.minSeconds = *std::min_element(wall.begin(), wall.end());
  timed.cpuSeconds = medianOf(cpu);
  return timed;
}

double meanOf(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double atRank(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

double medianOf(std::vector<double> values) {
  LORICA_CHECK(!values.empty(), "a median needs at least one value");
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

double fittedExponent(std::span<const double> x, std::span<const double> y) {
  double meanX = 0.0;
  double meanY = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    meanX += std::log(x[i]) / static_cast<double>(x.size());
    meanY += std::log(y[i]) / static_cast<double>(x.size());
  }
  double products = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    products += (std::log(x[i]) - meanX) * (std::log(y[i]) - meanY);
    squares += (std::log(x[i]) - meanX) * (std::log(x[i]) - meanX);
  }
  return products / squares;
}

DecomposePreset presetOf(const std::string& name) {
  if (name == "paper") return DecomposePreset::kPaper;
  return name == "fast" ? DecomposePreset::kFast : DecomposePreset::kQuality;
}

std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c == '\n' ? ' ' : c;
  }
  return quoted + '"';
}

void addInstructions(CLI::App& app) {
  app.add_option_function<std::string>(
         "--instructions",
         [](const std::string& set) {
           const std::int64_t newest = set == "SSE4" ? HWY_SSE4 : HWY_AVX2;
           hwy::DisableTargets(newest - 1);  // a newer set has a lower bit
         },
         "No newer ones than these")
      ->check(CLI::IsMember({"SSE4", "AVX2"}));
}

int fail(const Error& error) {
  fmt::print(stderr, "{}\n", error.message);
  return 2;
}

}  // namespace lorica::bench
