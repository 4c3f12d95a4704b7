#pragma once

#include "acd/decompose.h"

#include <string>

namespace lorica {

/// A decomposition and how long it took.
struct TimedDecomposition {
  Decomposition decomposition;
  double seconds = 0.0;
};

/// decompose() with a progress bar; Ctrl-C cancels it.
/// @param name  what is decomposed, for the bar and for errors: "Bunny.off"
[[nodiscard]] Result<TimedDecomposition> decomposeWithProgress(const std::string& name, const TriMesh& mesh,
                                                               PoseView keyframes, DecomposeSettings settings);

}  // namespace lorica
