#pragma once

#include "acd/decomposition.h"

#include <functional>

namespace lorica {

/// What decompose() tells while it works. Return false to cancel.
using DecomposeProgress = std::function<bool(int partsDone, int partsWanted)>;

/// How much work goes into the shapes. What each consists of: docs/DECOMPOSITION.md.
enum class DecomposePreset : std::uint8_t {
  kPaper,    ///< the algorithms as written: greedy cuts through the deepest concave edges
  kFast,     ///< more kinds of planes, scored coarsely; cut finer than asked, then merged
  kQuality,  ///< more of everything, the best planes refined, always the cut that gains most
};

struct DecomposeSettings {
  int maxParts = 16;  ///< M; 0 = until no concave edge remains (Algorithm 1)
  DecomposePreset preset = DecomposePreset::kFast;
  int candidateEdges = 0;  ///< C: concave edges tried for each cut, deepest first; 0 = the preset's (paper: 8)
  int planesPerEdge = 0;   ///< R: plane orientations for each of them; 0 = the preset's (paper: 5)
  /// With limits the parts are as few as keep one of them in every keyframe, and never more than maxParts unless that
  /// is 0. A limit of 0 is none.
  double maxError = 0.0;     ///< hull volume less mesh volume, as a share of the mesh's volume
  double maxDistance = 0.0;  ///< of any point of a part's hull from the part, see hullDistance() [m]
  int threads = 0;           ///< 0 = as many as the machine has; the result does not depend on it
  DecomposeProgress progress = {};
};

/// Cuts an animated mesh into parts whose hulls stay close to the surface in every keyframe.
///
/// Thul et al. 2018, Algorithm 3 (Algorithm 2 for a single keyframe); what the presets add: docs/DECOMPOSITION.md.
/// Same settings give the same parts on any number of threads.
/// @param mesh       closed two-manifold; its own positions are not used, only its triangles
/// @param keyframes  positions [m], keyframeCount x vertexCount, keyframe-major, at least one
/// @return the parts, or why the mesh was refused (kBadMesh), a setting (kInvalidArgument), or kCancelled
[[nodiscard]] Result<Decomposition> decompose(const TriMesh& mesh, PoseView keyframes,
                                              const DecomposeSettings& settings);

}  // namespace lorica
