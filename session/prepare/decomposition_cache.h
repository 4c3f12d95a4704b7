#pragma once

#include "acd/decompose.h"
#include "acd/decomposition_file.h"
#include "collision/hulls/cover_choice.h"
#include "session/prepare/training_motions.h"
#include "skinning/body/closed_body.h"
#include "skinning/character.h"

#include <filesystem>
#include <functional>
#include <string>

namespace lorica {

/// A folder of entries, each named by its key: a hash of everything that its content depends on (topology, keyframe
/// positions, settings, kAlgorithmVersion). An entry is a line with its key, then the bytes of a .lorica file. One that
/// is damaged or has another key is replaced; an unwritable folder causes a warning. There are bodies in it, too: see
/// cachedBody().
struct DecompositionCache {
  std::filesystem::path folder;                                ///< empty = no cache
  std::function<void(const std::string& sentence)> warn = {};  ///< none = warnings are dropped
};

/// $XDG_CACHE_HOME/lorica or ~/.cache/lorica; empty if neither variable holds an absolute path.
[[nodiscard]] std::filesystem::path userCacheFolder();

/// The parts of a subject, and where they are from.
struct CachedDecomposition {
  DecompositionFile file;  ///< what a `.lorica` file holds
  bool fromCache = false;  ///< read, not computed
  double seconds = 0.0;    ///< computation time; 0 if it came from the cache
};

/// The decomposition that `lorica demo` and `lorica play` use by default: 16 parts from the default keyframes.
/// @param settings  only threads and progress are used
[[nodiscard]] Result<CachedDecomposition> defaultDecomposition(const Character& character, const Training& training,
                                                               const DecomposeSettings& settings,
                                                               const DecompositionCache& cache);

/// The decomposition of a mesh.
/// @param name  of the mesh, for errors: "chair.obj"
[[nodiscard]] Result<CachedDecomposition> meshDecomposition(const std::string& name, const TriMesh& mesh,
                                                            const DecomposeSettings& settings,
                                                            const DecompositionCache& cache);

/// A cover of a decomposition: from the cache, or chosen by `choose`.
/// @param content  made from the character's mesh
/// @param request  not exact
[[nodiscard]] Result<HullCover> cachedCover(const Character& character, const DecompositionFile& content,
                                            const CoverPoses& poses, const CoverRequest& request,
                                            const std::function<Result<HullCover>()>& choose,
                                            const DecompositionCache& cache);

/// makeBody(), or its result from the cache, bit for bit the same. Only bodies that had to be built are kept, which
/// takes up to a second; settings.progress is not called for one from the cache.
///
/// Entries are files HASH.body, named by a hash of the character, the settings and kBodyVersion.
[[nodiscard]] Result<ClosedBody> cachedBody(const Character& character, const BodySettings& settings,
                                            const DecompositionCache& cache);

}  // namespace lorica
