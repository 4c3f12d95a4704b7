#pragma once

#include "geometry/result.h"

#include <filesystem>
#include <optional>

namespace lorica {

/// Makes place for a new file NAME.part.EXTENSION that is written while something is recorded: one that a killed
/// program left behind is renamed to NAME.found-1.EXTENSION, or the next free number.
/// @return its new name, nothing if there was none, or an error: another program is writing to it (it holds a lock, see
///         createPart()), or the folder is not writable
[[nodiscard]] Result<std::optional<std::filesystem::path>> keepFound(const std::filesystem::path& part);

/// Creates such a file, locked until its descriptor is closed, for appending.
/// @return the descriptor, or an error: it exists, or the folder is not writable
[[nodiscard]] Result<int> createPart(const std::filesystem::path& part);

}  // namespace lorica
