#pragma once

#include "geometry/result.h"

#include <nlohmann/json.hpp>

#include <string_view>

namespace lorica {

/// Parses a text that people write: comments are allowed, and keys that occur twice in an object, or more than 16
/// levels of lists and objects, are errors that name the place. Not by the parser's callback, which would look through
/// a list again after each object in it. For sources, not for installed headers.
[[nodiscard]] Result<nlohmann::ordered_json> parseWrittenJson(std::string_view text, std::string_view name);

}  // namespace lorica
