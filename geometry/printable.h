#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace lorica {

/// Text from files, arguments and devices for messages, as one line: control characters and bytes that are not UTF-8 as
/// \x1b, and the middle of long text replaced by its length. The result is printable and stays as it is.
/// @param longest  [bytes]
[[nodiscard]] std::string printable(std::string_view text, std::size_t longest = 1000);

}  // namespace lorica
