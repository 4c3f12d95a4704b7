#pragma once

#include "geometry/result.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// Whole content of a file, or a sentence: missing, a folder, not permitted.
[[nodiscard]] Result<std::string> readFile(const std::filesystem::path& file);

/// Writes a file whole or not at all: to a temporary file beside it, flushed, then renamed over the target.
[[nodiscard]] Result<void> writeFileAtomically(const std::filesystem::path& file, std::string_view content);

/// 64-bit content hash (XXH3), the same on every machine.
[[nodiscard]] std::uint64_t contentHash(std::string_view bytes, std::uint64_t seed = 0);

/// Sixteen lower-case hexadecimal digits.
[[nodiscard]] std::string hexDigits(std::uint64_t value);

}  // namespace lorica
