#pragma once

#include "prepare/decomposition_cache.h"
#include "skinning/body/closed_body.h"

namespace lorica {

/// makeBody(), or its result from the cache, bit for bit the same. Only bodies that had to be built are kept, which
/// takes up to a second; settings.progress is not called for one from the cache.
///
/// Entries are files HASH.body, named by a hash of the character, the settings and kBodyVersion.
[[nodiscard]] Result<ClosedBody> cachedBody(const Character& character, const BodySettings& settings,
                                            const DecompositionCache& cache);

}  // namespace lorica
