#pragma once

#include "acd/decomposition_file.h"
#include "collision/hulls/cover_choice.h"
#include "collision/hulls/file_content.h"
#include "session/prepare/decomposition_cache.h"
#include "session/prepare/subject.h"

#include <string>

namespace lorica {

/// Options that select the body of a character.
struct BodyOptions {
  std::string decomposition;  ///< file; empty = defaultDecomposition()
  CoverRequest cover;         ///< not given = the cover in the file
};

/// The user's cache; its warnings go to the host, which must outlive it.
[[nodiscard]] DecompositionCache userCache(Host& host);

/// defaultDecomposition() with the character's default training, the user's cache, as a task of the host.
[[nodiscard]] Result<CachedDecomposition> defaultDecomposition(const Subject& subject, Host& host);

/// meshDecomposition() with the user's cache, as a task of the host.
[[nodiscard]] Result<CachedDecomposition> meshDecomposition(const std::string& name, const TriMesh& mesh,
                                                            DecomposeSettings settings, Host& host);

/// The decomposition with the requested cover; without a request, its own cover, or an exact one if it has none.
/// @param subject  a character
/// @return the body, or an error if the file was made from another mesh or cannot be read
[[nodiscard]] Result<DecompositionFile> chooseBody(const BodyOptions& options, const Subject& subject, Host& host);

/// The body as one part, without cuts: for pictures that show no hulls, of bodies that touch nothing. Takes no time.
/// @param subject  a character
[[nodiscard]] DecompositionFile wholeBody(const Subject& subject);

}  // namespace lorica
