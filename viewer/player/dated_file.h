#pragma once

#include "geometry/result.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace lorica {

/// A new name of today in a folder, such as 2026-03-01_002.lsession; at most 999 of a kind a day. What others
/// ask for never fills the disk: less than 2 GiB free is an error.
/// @param ending  with its dot
[[nodiscard]] Result<std::string> newDatedFile(const std::filesystem::path& folder, std::string_view ending);

}  // namespace lorica
