#pragma once

#include "geometry/result.h"

#include <filesystem>
#include <string>

namespace lorica {

/// Which files a file may name: another one may come from a stranger.
enum class PathTrust {
  kBeneath,  ///< those in its own folder and below
  kAnywhere  ///< any
};

/// Where a file finds the files that it names.
struct NamedFiles {
  std::filesystem::path folder = {};      ///< of the file that names them
  PathTrust trust = PathTrust::kBeneath;  ///< which paths it may name

  /// The path of a file, to be read with NamedBy::kFile. The one rule for every file that names files: the name is
  /// relative, has neither "..", a drive or scheme nor a zero byte, and symbolic links do not lead out of the folder.
  /// With PathTrust::kAnywhere only the zero byte is refused.
  /// @param name  as in the file; backslashes count as slashes
  /// @return the path, which need not exist; or an error with the name and what was expected
  [[nodiscard]] Result<std::filesystem::path> find(std::string name) const;
};

}  // namespace lorica
