#pragma once

#include "acd/decompose.h"
#include "apps/inputs.h"
#include "session/prepare/training.h"

#include <span>
#include <string>

namespace lorica {

/// trainingMotions() of session/prepare for motions given by name. The shipped recordings are the usual motions.
/// @param motions  paths or names, see readMotion(); may be empty
/// @param atHand   the motion that will be played, if it is known: used, with a warning, where the shipped recordings
///                 are not found; null = then that is an error
[[nodiscard]] Result<Training> trainingMotions(const Subject& subject, std::span<const std::string> motions,
                                               const Motion* atHand = nullptr);

/// A decomposition and its computation time.
struct TimedDecomposition {
  Decomposition decomposition;
  double seconds = 0.0;
};

/// decompose() with a progress bar; Ctrl-C cancels.
/// @param name  of the mesh, for the bar and for errors: "Bunny.off"
[[nodiscard]] Result<TimedDecomposition> decomposeWithProgress(const std::string& name, const TriMesh& mesh,
                                                               PoseView keyframes, DecomposeSettings settings);

}  // namespace lorica
