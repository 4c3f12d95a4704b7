#pragma once

#include "geometry/result.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace lorica {

/// Who named a file.
enum class NamedBy {
  kUser,    ///< on the command line: pipes are read to their end, and links are followed when it is written
  kFile,    ///< in another file: it must be a regular file, and opening it never waits
  kLorica,  ///< Lorica itself, in a folder of its own or one that the user named: as kFile, and a link is replaced
  kSecret   ///< as kLorica, and from its first byte only this user may read it
};

/// Limit of most formats [bytes]. A table of all limits is in docs/SECURITY.md.
inline constexpr std::uint64_t kMaxFileBytes = std::uint64_t{256} << 20;

/// Reads the whole content of a file.
/// @param maxBytes  a larger regular file is refused before anything of it is read
/// @return the content, or an error: file missing, a folder, a device, not permitted, too large
[[nodiscard]] Result<std::string> readFile(const std::filesystem::path& file, NamedBy by = NamedBy::kUser,
                                           std::uint64_t maxBytes = kMaxFileBytes);

/// Writes a file completely or not at all: writes a temporary file in the same folder, flushes it and renames it to the
/// target.
[[nodiscard]] Result<void> writeFileAtomically(const std::filesystem::path& file, std::string_view content,
                                               NamedBy by = NamedBy::kUser);

/// Whether a folder holds what Lorica wrote: it belongs to this user, and not everybody may write into it or rename it.
/// What is in another one is neither read nor replaced.
[[nodiscard]] Result<void> checkOwnFolder(const std::filesystem::path& folder);

/// Makes a folder for files that Lorica names itself, open to this user alone, and what it lies in; checks one that is
/// there.
[[nodiscard]] Result<void> makeOwnFolder(const std::filesystem::path& folder);

/// Returns a 64-bit content hash (XXH3), the same on every machine.
[[nodiscard]] std::uint64_t contentHash(std::string_view bytes, std::uint64_t seed = 0);

/// Formats a value as 16 lower-case hexadecimal digits.
[[nodiscard]] std::string hexDigits(std::uint64_t value);

}  // namespace lorica
