#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
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

struct CommandSurroundings {
  std::filesystem::path folder = ".";  ///< working folder
  std::filesystem::path cache{};       ///< XDG_CACHE_HOME; empty = a folder that cannot be written
  int interruptAfterMs = 0;            ///< when to send SIGINT; 0 = never
  std::string virtualCamera{};         ///< LORICA_VIRTUAL: script of the virtual camera; empty = not set
  std::string display{};               ///< DISPLAY; empty = not set
  std::filesystem::path recordings{};  ///< LORICA_RECORDINGS; empty = those of the source tree
  std::filesystem::path libraries{};   ///< LD_LIBRARY_PATH, searched before the modules of the build; empty = not set
};

/// Runs `lorica arguments...`, without a display if none is given.
[[nodiscard]] CommandResult runLorica(const std::vector<std::string>& arguments,
                                      const CommandSurroundings& surroundings = {});

/// Names in a folder, sorted.
[[nodiscard]] std::vector<std::string> filesIn(const std::filesystem::path& folder);

}  // namespace lorica::test
