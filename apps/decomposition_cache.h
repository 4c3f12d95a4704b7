#pragma once

#include "acd/decomposition_file.h"
#include "apps/cover_options.h"
#include "apps/inputs.h"
#include "skinning/character.h"

#include <filesystem>

namespace lorica {

/// The decomposition that `demo` and `play` use when none is given: 16 parts from up to 12 keyframes of what the
/// character trains on by default, see trainingMotions().
struct DefaultDecomposition {
  DecompositionFile file;
  bool fromCache = false;
  double seconds = 0.0;  ///< that computing it took; 0 from the cache
};

/// Computes it the first time, with a progress bar, and keeps it in the cache under a hash of all that it depends on:
/// topology, keyframe positions, settings, version of the algorithm. A damaged cache file is computed again, a cache
/// that cannot be written is a warning.
[[nodiscard]] Result<DefaultDecomposition> defaultDecomposition(const Subject& subject, int threads);

/// A cover of a decomposition, chosen in poses of what the character trains on by default: computed the first time,
/// with a progress bar, and kept in the cache as the decomposition is.
/// @param subject  a character
/// @param content  made from its mesh
/// @param request  not exact
[[nodiscard]] Result<CoverPromise> cachedCover(const Subject& subject, const DecompositionFile& content,
                                               const CoverRequest& request, int threads);

/// A mesh in so many parts, preset fast: computed the first time, with a progress bar, and kept in the cache as
/// characters' are; Ctrl-C cancels it.
/// @param name  what is decomposed, for the bar and for errors: "chair.obj"
[[nodiscard]] Result<Decomposition> cachedMeshDecomposition(const std::string& name, const TriMesh& mesh, int parts);

/// $XDG_CACHE_HOME/lorica or ~/.cache/lorica; empty where neither variable holds an absolute path.
[[nodiscard]] std::filesystem::path cacheFolder();

}  // namespace lorica
