#pragma once

#include "geometry/result.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

// Errors in one call: badFormat("{}:{}: found {}, expected {}", file, line, found, expected). For sources, not for
// installed headers: it needs fmt.

namespace lorica {

#define LORICA_ERROR_FACTORY(name, code)                                               \
  [[nodiscard]] inline Error name(std::string sentence) {                              \
    return {code, std::move(sentence)};                                                \
  }                                                                                    \
  template <typename... Values>                                                        \
  [[nodiscard]] Error name(fmt::format_string<Values...> format, Values&&... values) { \
    return {code, fmt::format(format, std::forward<Values>(values)...)};               \
  }

LORICA_ERROR_FACTORY(notFound, ErrorCode::kNotFound)
LORICA_ERROR_FACTORY(unreadable, ErrorCode::kUnreadable)
LORICA_ERROR_FACTORY(unwritable, ErrorCode::kUnwritable)
LORICA_ERROR_FACTORY(badFormat, ErrorCode::kBadFormat)
LORICA_ERROR_FACTORY(badMesh, ErrorCode::kBadMesh)
LORICA_ERROR_FACTORY(invalidArgument, ErrorCode::kInvalidArgument)
LORICA_ERROR_FACTORY(unsupported, ErrorCode::kUnsupported)
LORICA_ERROR_FACTORY(noDisplay, ErrorCode::kNoDisplay)
#undef LORICA_ERROR_FACTORY

/// @param error  an errno
[[nodiscard]] inline Error unwritable(const std::filesystem::path& file, int error) {
  return unwritable("{}: cannot be written: {}", file.string(), std::generic_category().message(error));
}

[[nodiscard]] inline Error cancelled() {
  return {ErrorCode::kCancelled, "cancelled"};
}

/// A result whose error, if it has one, says first where: prefixed(file, parse(text)) fails with "FILE: ...".
template <typename T>
[[nodiscard]] Result<T> prefixed(std::string_view where, Result<T> result) {
  if (result.ok()) return result;
  return Error{result.error().code, fmt::format("{}: {}", where, result.error().message)};
}

/// The kinds of errors by their names in reports: "badFormat".
inline constexpr std::array<std::string_view, 9> kErrorNames = {"notFound",    "unreadable", "unwritable",
                                                                "badFormat",   "badMesh",    "invalidArgument",
                                                                "unsupported", "noDisplay",  "cancelled"};
[[nodiscard]] inline std::string_view nameOf(ErrorCode code) {
  return kErrorNames[static_cast<std::size_t>(code)];
}

inline constexpr std::string_view kOutOfMemory = "outOfMemory";  ///< thrown by the standard library, no ErrorCode

}  // namespace lorica
