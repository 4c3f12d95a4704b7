#pragma once

#include "prepare/decomposition_cache.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace lorica {

/// The file of an entry; empty if there is no cache.
/// @param extension  ".lorica"
[[nodiscard]] std::filesystem::path cacheFile(const DecompositionCache& cache, std::uint64_t key,
                                              const char* extension);

/// Whether there is an entry to be read. Something else than a regular file causes a warning.
[[nodiscard]] bool hasEntry(const DecompositionCache& cache, const std::filesystem::path& file);

/// Warns that an entry cannot be used. @param problem  with the name of the file
void warnOfEntry(const DecompositionCache& cache, const std::string& problem);

/// Writes an entry. What goes wrong causes a warning.
void keepEntry(const DecompositionCache& cache, const std::filesystem::path& file,
               const std::function<Result<void>()>& write);

}  // namespace lorica
