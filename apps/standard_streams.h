#pragma once

#include "geometry/result.h"

#include <string_view>

namespace lorica {

/// Opens standard input, output and error if the program was started without them; otherwise the next file would take
/// their place, and messages would be written into it. Writing to those that were missing is an error.
void openStandardStreams();

/// Prints to standard error. What cannot be written there is dropped, for there is no other place to say so.
void say(std::string_view text);

/// Prints to standard output. @param what  for the error message: "the report"
[[nodiscard]] Result<void> print(std::string_view text, std::string_view what);

}  // namespace lorica
