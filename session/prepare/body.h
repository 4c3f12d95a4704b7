#pragma once

#include "acd/decompose.h"
#include "acd/decomposition_file.h"
#include "collision/hulls/cover_choice.h"
#include "collision/hulls/file_content.h"
#include "session/prepare/subject.h"
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
