#pragma once

#include "geometry/result.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace lorica {

/// Whether a URI holds its data itself: "data:application/octet-stream;base64,AAAA".
[[nodiscard]] bool isDataUri(std::string_view uri);

/// The bytes of a data URI in base64, or what is wrong with it.
[[nodiscard]] Result<std::string> decodeDataUri(std::string_view uri);

/// The relative path that a URI names, %20 and the like decoded; none where it is absolute, has a scheme or a
/// drive, or climbs out by "..".
[[nodiscard]] std::optional<std::filesystem::path> neighbourFile(std::string_view uri);

}  // namespace lorica
