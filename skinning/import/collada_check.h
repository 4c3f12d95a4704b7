#pragma once

#include "geometry/result.h"

#include <string>
#include <string_view>

namespace lorica {

/// Looks for what assimp 5.2 does not bear in a COLLADA file: lists of whole numbers that hold anything else make it
/// run for ever, and accessors that reach beyond their array make it end the program.
/// @param text  of the file in UTF-8
[[nodiscard]] Result<void> checkCollada(std::string_view text, const std::string& name);

}  // namespace lorica
