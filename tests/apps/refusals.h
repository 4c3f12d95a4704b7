#pragma once

#include "tests/apps/run_command.h"
#include "tests/support/has.h"

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

namespace lorica::test {

/// Expects that a command was refused in a sentence with these parts.
inline void expectRefused(const CommandResult& result, const std::vector<std::string_view>& parts) {
  EXPECT_EQ(result.exitCode, 2) << result.err;
  expectAll(result.err, parts);
}

/// Runs a command in a folder, and expects that it is refused and leaves no file.
inline void expectRefused(const TemporaryFolder& folder, const std::vector<std::string>& arguments,
                          const std::vector<std::string_view>& parts) {
  const std::vector<std::string> before = filesIn(folder.path());
  CommandSurroundings surroundings;
  surroundings.folder = folder.path();
  expectRefused(runLorica(arguments, surroundings), parts);
  EXPECT_EQ(filesIn(folder.path()), before);
}

}  // namespace lorica::test
