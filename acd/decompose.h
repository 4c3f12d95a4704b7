#pragma once

#include "acd/decomposition.h"

#include <functional>

namespace lorica {

/// What decompose() tells while it works. Return false to cancel.
using DecomposeProgress = std::function<bool(int partsDone, int partsWanted)>;

/// Settings of the paper's Algorithms 2 and 3.
struct DecomposeSettings {
  int maxParts = 16;       ///< M; 0 = until no concave edge remains (Algorithm 1)
  int candidateEdges = 8;  ///< C: concave edges tried for each cut, those furthest from the hull
  int planesPerEdge = 5;   ///< R: plane orientations for each of them
  int threads = 0;         ///< 0 = as many as the machine has; the result does not depend on it
  DecomposeProgress progress = {};
};

/// Cuts an animated mesh into parts whose hulls stay close to the surface in every keyframe.
///
/// Thul et al. 2018, Algorithm 3 (Algorithm 2 for a single keyframe). Departures: docs/DECOMPOSITION.md.
/// Same settings give the same parts on any number of threads.
/// @param mesh       closed two-manifold; its own positions are not used, only its triangles
/// @param keyframes  positions [m], keyframeCount x vertexCount, keyframe-major, at least one
/// @return the parts, or why the mesh was refused (kBadMesh), a setting (kInvalidArgument), or kCancelled
[[nodiscard]] Result<Decomposition> decompose(const TriMesh& mesh, PoseView keyframes,
                                              const DecomposeSettings& settings);

}  // namespace lorica
