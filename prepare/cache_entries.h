#pragma once

#include "prepare/decomposition_cache.h"
#include "skinning/body/closed_body.h"

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

/// makeBody(), or its result from the cache, bit for bit the same. Only bodies that had to be built are kept, which
/// takes up to a second; settings.progress is not called for one from the cache.
///
/// Entries are files HASH.body, named by a hash of the character, the settings and kBodyVersion.
[[nodiscard]] Result<ClosedBody> cachedBody(const Character& character, const BodySettings& settings,
                                            const DecompositionCache& cache);

}  // namespace lorica
