#pragma once

#include "geometry/math.h"
#include "geometry/tri_mesh.h"
#include "skinning/morphs/expressions.h"
#include "skinning/morphs/morphs.h"

#include <span>
#include <vector>

namespace lorica {

/// Weights of the targets that a run sets, for reachedPositions(): the chosen expressions alone, and upon every clip of
/// the file at its keys. Clips with splines or more than 512 keys are sampled at 512 times, fewer if there are many
/// clips: at most 4,096 sets are made. Blinking and gaze are left out: they last a moment and move millimetres.
/// @param chosen  one weight for each expression
/// @return setCount x targetCount
[[nodiscard]] std::vector<float> usedWeightSets(const Morphs& morphs, const Expressions& expressions,
                                                std::span<const float> chosen);

/// A position in the bind pose that a vertex reaches by morph targets.
struct ReachedPosition {
  VertexIndex vertex = 0;        ///< of the mesh
  Vec3 position{0.0, 0.0, 0.0};  ///< [m], model space
};

/// The outermost positions that vertices reach for some weights of the targets, for hulls that must contain them.
///
/// Of each vertex the extreme positions along 13 axes are kept (through the faces, edges and corners of a cube),
/// without repeats. They are all that is needed if targets move the vertex along one line, as a single target does.
/// Otherwise their hull may miss other positions by about 15 % of the vertex' way.
/// @param weightSets     setCount x targetCount, such as all keys of a clip; blends of the sets are covered too
/// @param bindPositions  [m], model space
/// @param threshold      vertices that move less than this in every set are left out [m]
[[nodiscard]] std::vector<ReachedPosition> reachedPositions(const Morphs& morphs, std::span<const float> weightSets,
                                                            std::span<const Vec3> bindPositions, double threshold);

}  // namespace lorica
