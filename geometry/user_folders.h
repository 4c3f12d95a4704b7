#pragma once

#include "geometry/text.h"

#include <filesystem>

namespace lorica {

/// The user's folder for files of one kind: "lorica" in $XDG_CACHE_HOME or ~/.cache, say; empty if neither is set. As
/// the XDG specification requires, relative paths are ignored.
/// @param variable  "XDG_CACHE_HOME"
/// @param inHome    where it is without that variable: ".cache"
[[nodiscard]] inline std::filesystem::path userFolder(const char* variable, const char* inHome) {
  if (const std::filesystem::path folder = environment(variable); folder.is_absolute()) return folder / "lorica";
  if (const std::filesystem::path home = environment("HOME"); home.is_absolute()) return home / inHome / "lorica";
  return {};
}

}  // namespace lorica
