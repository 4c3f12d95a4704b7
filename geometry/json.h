#pragma once

#include "geometry/errors.h"
#include "geometry/result.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <string_view>
#include <type_traits>

// The one way to read JSON. For sources, not for installed headers: it needs nlohmann's.

namespace lorica {

/// What a JSON text may ask for. Deeper texts overflow the stack of whatever walks them, the ordered objects that
/// Lorica reads scenes, maps and descriptions into take quadratic time for members, and `{},` takes 100 bytes when it
/// is read.
struct JsonLimits {
  int levels = 64;                ///< of lists and objects inside each other
  std::size_t members = 100'000;  ///< of one object
  std::size_t holders = 500'000;  ///< lists, objects and texts, or one for every 8 bytes of the text if that is more
};
inline constexpr JsonLimits kOrderedJson{64, 2'048};

/// Checks brackets and commas only, in one pass and without memory: what is no JSON is found when it is parsed. It can
/// be stopped; parsing, which follows, cannot.
[[nodiscard]] Result<void> checkJson(std::string_view text, const JsonLimits& limits);

/// Parses a text from outside.
/// @param name  of the file, for the message
template <typename Json = nlohmann::json>
[[nodiscard]] Result<Json> parseJson(std::string_view text, std::string_view name,
                                     const JsonLimits& limits = std::is_same_v<Json, nlohmann::json> ? JsonLimits()
                                                                                                     : kOrderedJson) {
  LORICA_TRY_DO(prefixed(name, checkJson(text, limits)));
  try {
    return Json::parse(text);
  } catch (const typename Json::exception& problem) {
    return badFormat("{}: its JSON is broken: {}", name, problem.what());
  }
}

/// Parses a text that people write: comments are allowed, and keys that occur twice in an object, or more than 16
/// levels of lists and objects, are errors that name the place. Not by the parser's callback, which would look through
/// a list again after each object in it. For sources, not for installed headers.
[[nodiscard]] Result<nlohmann::ordered_json> parseWrittenJson(std::string_view text, std::string_view name);

}  // namespace lorica
