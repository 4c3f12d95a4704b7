#pragma once

#include "geometry/result.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace lorica {

/// Whether a URI contains its data itself: "data:application/octet-stream;base64,AAAA".
[[nodiscard]] bool isDataUri(std::string_view uri);

/// The bytes of a data URI in base64, or an error.
[[nodiscard]] Result<std::string> decodeDataUri(std::string_view uri);

/// The relative path of a URI, percent-decoded; none if it is absolute, has a scheme or a drive, or contains "..".
[[nodiscard]] std::optional<std::filesystem::path> neighbourFile(std::string_view uri);

/// The same for a path without percent-encoding, with slashes or backslashes.
[[nodiscard]] std::optional<std::filesystem::path> neighbourPath(std::string name);

}  // namespace lorica
