#pragma once

#include "geometry/result.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// Reads the whole content of a file.
/// @return the content, or an error: file missing, a folder, not permitted
[[nodiscard]] Result<std::string> readFile(const std::filesystem::path& file);

/// Writes a file completely or not at all: writes a temporary file in the same folder, flushes it and renames it to the
/// target.
[[nodiscard]] Result<void> writeFileAtomically(const std::filesystem::path& file, std::string_view content);

/// Returns a 64-bit content hash (XXH3), the same on every machine.
[[nodiscard]] std::uint64_t contentHash(std::string_view bytes, std::uint64_t seed = 0);

/// Formats a value as 16 lower-case hexadecimal digits.
[[nodiscard]] std::string hexDigits(std::uint64_t value);

}  // namespace lorica
