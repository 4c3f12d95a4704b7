#pragma once

#include <string>

namespace lorica {

/// A text file's bytes as UTF-8. UTF-16, which Windows calls "Unicode", is recognised by its byte order mark, or by a
/// zero beside the first letter, and converted; everything else is returned as it is.
[[nodiscard]] std::string asUtf8(std::string bytes);

}  // namespace lorica
