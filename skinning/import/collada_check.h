#pragma once

#include "geometry/result.h"

#include <string>
#include <string_view>

namespace lorica {

/// Rejects COLLADA files that assimp 5.2 cannot handle: lists of whole numbers with other content cause an endless
/// loop, and accessors that reach beyond their array terminate the program.
/// @param text  of the file in UTF-8
[[nodiscard]] Result<void> checkCollada(std::string_view text, const std::string& name);

}  // namespace lorica
