#pragma once

#include "tests/support/datasets.h"

#include <sys/stat.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace lorica::test {

/// Folder for what tests of this build of the command make once and share; another build begins with an empty one.
inline std::filesystem::path sharedByTests(std::string_view what) {
  struct stat program {};
  stat(built("lorica").c_str(), &program);
  const std::filesystem::path folder =
      built("tests") / what / std::to_string(program.st_mtim.tv_sec * 1'000'000'000 + program.st_mtim.tv_nsec);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace lorica::test
