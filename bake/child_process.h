#pragma once

#include "geometry/result.h"

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lorica {

/// A program to run.
struct ProcessOrder {
  std::filesystem::path program;
  std::vector<std::string> arguments;
  std::vector<std::pair<std::string, std::string>> environment;  ///< set besides what this process has
  std::filesystem::path output;                                  ///< file for what it prints, both streams
  std::uint64_t memoryBytes = 0;                                 ///< limit of its own memory; 0 = none
};

/// How a program ended.
struct ProcessEnd {
  int exitStatus = 0;            ///< if no signal ended it
  int signal = 0;                ///< that ended it; 0 = none
  double cpuSeconds = 0.0;       ///< of all its threads and of processes that it waited for
  std::uint64_t peakMemory = 0;  ///< largest resident memory of one process [bytes]
};

/// A running program. It is ended when this goes out of scope, and also if this process is killed. It is in a process
/// group of its own, so that Ctrl-C reaches this process alone.
class ChildProcess {
 public:
  [[nodiscard]] static Result<ChildProcess> start(const ProcessOrder& order);
  ~ChildProcess();
  ChildProcess(ChildProcess&& other) noexcept : process_(std::exchange(other.process_, -1)) {}
  ChildProcess& operator=(ChildProcess&& other) noexcept;

  /// How it ended; none while it runs. Never blocks.
  [[nodiscard]] std::optional<ProcessEnd> ended();
  /// Ends it and waits until it is gone.
  void kill();

 private:
  explicit ChildProcess(pid_t process) : process_(process) {}
  pid_t process_;  // -1 = none, or ended
};

}  // namespace lorica
