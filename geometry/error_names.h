#pragma once

#include "geometry/result.h"

#include <array>
#include <cstddef>
#include <string_view>

namespace lorica {

/// The kinds of errors by their names in reports: "badFormat".
inline constexpr std::array<std::string_view, 9> kErrorNames = {"notFound",    "unreadable", "unwritable",
                                                                "badFormat",   "badMesh",    "invalidArgument",
                                                                "unsupported", "noDisplay",  "cancelled"};
[[nodiscard]] inline std::string_view nameOf(ErrorCode code) {
  return kErrorNames[static_cast<std::size_t>(code)];
}

inline constexpr std::string_view kOutOfMemory = "outOfMemory";  ///< thrown by the standard library, no ErrorCode

}  // namespace lorica
