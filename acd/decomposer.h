#pragma once

#include "acd/decompose.h"

namespace lorica {

/// Runs the preset. `quality` also does what `fast` does, improves whichever parts are better, and returns no worse
/// ones than `fast`.
/// @param keyframes  checked; in the frame in which the planes are chosen
[[nodiscard]] Result<Decomposition> cutAndMerge(const TriMesh& mesh, PoseView keyframes,
                                                const DecomposeSettings& settings);

}  // namespace lorica
