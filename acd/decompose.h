#pragma once

#include "acd/decomposition.h"

#include <cstdint>
#include <functional>

namespace lorica {

/// Progress callback of decompose(). Return false to cancel.
/// @param partsWanted  maxParts; without that, as many as are expected from what is done so far, or 0 if too little is
using DecomposeProgress = std::function<bool(int partsDone, int partsWanted)>;

/// Trade-off between run time and quality of the parts. Details: docs/DECOMPOSITION.md.
enum class DecomposePreset : std::uint8_t {
  kPaper,    ///< the algorithms as written: greedy cuts through the deepest concave edges
  kFast,     ///< more kinds of planes, scored coarsely; makes more parts than requested, then merges
  kQuality,  ///< more candidates, the best planes refined, always the cut with the largest gain
};

/// Increase this when decompose() or chooseCover() gives a different result for the same input, or when .lorica files
/// hold more data, so that caches written by older versions are not used.
inline constexpr std::uint64_t kAlgorithmVersion = 16;

/// How a mesh is cut, and when cutting stops; whichever limit is reached first.
struct DecomposeSettings {
  /// M: at most as many, fewer if that leaves the hulls as tight. 0 = until no concave edge remains (Algorithm 1) that
  /// is deeper than 1e-5 of the diagonal, the noise of files with 6 digits
  int maxParts = 16;
  DecomposePreset preset = DecomposePreset::kFast;  ///< what the zeros below stand for
  int candidateEdges = 0;  ///< C: concave edges tried for each cut, deepest first; 0 = preset's value (paper: 8)
  int planesPerEdge = 0;   ///< R: plane orientations for each edge; 0 = preset's value (paper: 5)
  /// With limits, the number of parts is the smallest that meets all of them in every keyframe, but at most maxParts
  /// unless that is 0. A limit of 0 is no limit. They are about the parts' hulls, see partHull(), and not about larger
  /// ones with fewer vertices.
  double maxError = 0.0;      ///< (hull volume - mesh volume) / mesh volume
  double maxDistance = 0.0;   ///< of any point of a part's hull from the part, see hullDistance() [m]
  double maxConcavity = 0.0;  ///< of any part, see partConcavity() [m]
  /// The mesh keeps its shape, and has one keyframe. Then its parts do not depend on how its file divides flat faces
  /// into triangles, nor on the order of vertices and triangles: what mergeFlatFaces() leaves is cut. Vertices that
  /// flat faces do not need are in no part, and up to 3e-7 of the diagonal outside the hulls.
  bool rigid = false;
  int threads = 0;                  ///< 0 = all of the machine's; the result does not depend on it
  DecomposeProgress progress = {};  ///< called as parts are cut; empty = nobody listens
};

/// Decomposes an animated mesh into parts whose hulls are close to the surface in every keyframe.
///
/// Thul et al. 2018, Algorithm 3 (Algorithm 2 for a single keyframe); additions of the presets: docs/DECOMPOSITION.md.
/// The same settings give the same parts on any number of threads.
/// @param mesh       closed two-manifold; only its triangles are used, not its positions
/// @param keyframes  positions [m], keyframeCount x vertexCount, keyframe-major, at least one
/// @return the parts, or an error: invalid mesh (kBadMesh), invalid setting (kInvalidArgument), or kCancelled
[[nodiscard]] Result<Decomposition> decompose(const TriMesh& mesh, PoseView keyframes,
                                              const DecomposeSettings& settings);

}  // namespace lorica
