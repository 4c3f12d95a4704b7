#pragma once

#include "geometry/result.h"

#include <cstdint>
#include <filesystem>
#include <functional>
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
  bool stopped = false;          ///< by this process
  int exitStatus = 0;            ///< if no signal ended it
  int signal = 0;                ///< that ended it; 0 = none
  double cpuSeconds = 0.0;       ///< of all its threads and of processes that it waited for
  std::uint64_t peakMemory = 0;  ///< largest resident memory of one process [bytes]
};

/// Runs a program to its end, in a process group of its own, so that Ctrl-C reaches this process alone. It is ended if
/// this process is killed.
/// @param goOn  asked every few milliseconds: if not, the program and what it started are ended
[[nodiscard]] Result<ProcessEnd> runProgram(const ProcessOrder& order, const std::function<bool()>& goOn);

}  // namespace lorica
