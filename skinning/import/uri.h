#pragma once

#include "geometry/result.h"

#include <string>
#include <string_view>

namespace lorica {

/// Whether a URI contains its data itself: "data:application/octet-stream;base64,AAAA".
[[nodiscard]] bool isDataUri(std::string_view uri);

/// The bytes of a data URI in base64, or an error.
[[nodiscard]] Result<std::string> decodeDataUri(std::string_view uri);

/// A URI with "%20" as " " and so on, the name of a file for NamedFiles.
[[nodiscard]] std::string percentDecoded(std::string_view uri);

}  // namespace lorica
