#pragma once

#include "acd/decompose.h"
#include "prepare/read_motion.h"
#include "prepare/subject.h"
#include "prepare/training.h"

#include <span>
#include <string>
#include <vector>

namespace lorica {

/// Reads motions by paths or names, see readMotion().
[[nodiscard]] Result<std::vector<Motion>> readMotions(std::span<const std::string> names, Host& host);

/// trainingMotions() of session/prepare. The shipped recordings are the usual motions.
/// Where they are not found, they are generated again, with a warning.
/// @param motions  may be empty
[[nodiscard]] Result<Training> trainingMotions(const Subject& subject, std::span<const Motion> motions, Host& host);

/// A decomposition and its computation time.
struct TimedDecomposition {
  Decomposition decomposition;
  double seconds = 0.0;
};

/// decompose() as a task of the host.
/// @param name  of the mesh, for the task and for errors: "Bunny.off"
[[nodiscard]] Result<TimedDecomposition> decomposeWithProgress(const std::string& name, const TriMesh& mesh,
                                                               PoseView keyframes, DecomposeSettings settings,
                                                               Host& host);

}  // namespace lorica
