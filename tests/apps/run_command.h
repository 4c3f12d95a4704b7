#pragma once

#include "tests/support/datasets.h"

#include <nlohmann/json.hpp>

#include <sys/types.h>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace lorica::test {

/// Output and exit code of a run of the command.
struct CommandResult {
  int exitCode = -1;  ///< 128 + the signal's number if a signal ended it
  std::string out;
  std::string err;

  /// Parses standard output, which must be JSON only; else the test fails.
  [[nodiscard]] nlohmann::json json() const;
};

/// A command while it runs.
struct RunningCommand {
  pid_t process = -1;
  std::string err;  ///< so far
};

struct CommandSurroundings {
  std::filesystem::path folder = ".";  ///< working folder
  std::filesystem::path cache{};       ///< XDG_CACHE_HOME; empty = one that all tests of this build share
  std::function<bool(const RunningCommand&)> interruptWhen{};  ///< when to send SIGINT; empty = never
  std::string virtualCamera{};         ///< LORICA_VIRTUAL: script of the virtual camera; empty = not set
  std::string display{};               ///< DISPLAY; empty = not set
  std::filesystem::path recordings{};  ///< LORICA_RECORDINGS; empty = those of the source tree
  std::filesystem::path libraries{};   ///< LD_LIBRARY_PATH, searched before the modules of the build; empty = not set
};

/// For interruptWhen: it has used so much of a processor, however busy the machine is.
[[nodiscard]] bool hasWorked(const RunningCommand& command, double seconds);

/// Runs `lorica arguments...`, without a display if none is given.
[[nodiscard]] CommandResult runLorica(const std::vector<std::string>& arguments,
                                      const CommandSurroundings& surroundings = {});

/// What a command reports with `--json -`. It must end well; else the test fails.
[[nodiscard]] nlohmann::json jsonOf(std::vector<std::string> arguments, const CommandSurroundings& surroundings = {});

/// body.lorica in a folder: of the mannequin, of few parts from two keyframes, which tests of this build share.
[[nodiscard]] std::filesystem::path mannequinBody(const TemporaryFolder& folder, int parts = 5);

/// Names in a folder, sorted.
[[nodiscard]] std::vector<std::string> filesIn(const std::filesystem::path& folder);

}  // namespace lorica::test
