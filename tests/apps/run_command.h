#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace lorica::test {

/// What a run of the command left behind.
struct CommandResult {
  int exitCode = -1;  ///< 128 + the signal's number where one ended it
  std::string out;
  std::string err;

  /// Standard output, which must be JSON and nothing else. Fails the test when it is not.
  [[nodiscard]] nlohmann::json json() const;
};

struct CommandSurroundings {
  std::filesystem::path folder = ".";  ///< where it runs
  std::filesystem::path cache{};       ///< XDG_CACHE_HOME; empty = a folder that cannot be written
  int interruptAfterMs = 0;            ///< send SIGINT then; 0 = never
  std::string virtualCamera{};         ///< LORICA_VIRTUAL: what the virtual camera shows; empty = not set
  std::string display{};               ///< DISPLAY; empty = not set
  std::filesystem::path libraries{};   ///< LD_LIBRARY_PATH, searched before the modules of the build; empty = not set
};

/// Runs `lorica arguments...`, without a display where none is given, on the recordings of the source tree.
[[nodiscard]] CommandResult runLorica(const std::vector<std::string>& arguments,
                                      const CommandSurroundings& surroundings = {});

/// Names in a folder, sorted.
[[nodiscard]] std::vector<std::string> filesIn(const std::filesystem::path& folder);

}  // namespace lorica::test
