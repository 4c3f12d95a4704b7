#pragma once

#include "geometry/math.h"
#include "geometry/tri_mesh.h"
#include "skinning/clip.h"

#include <span>
#include <string>
#include <vector>

namespace lorica {

struct Expressions;

/// What a morph target adds to one vertex at weight 1.
struct MorphOffset {
  VertexIndex vertex = 0;            ///< of the mesh
  Vec3f position{0.0F, 0.0F, 0.0F};  ///< [m], model space
  Vec3f normal{0.0F, 0.0F, 0.0F};    ///< added to the vertex' unit normal, which is then normalised again
};

/// A shape that the mesh can be blended towards.
struct MorphTarget {
  std::string name;  ///< in the file; may be empty
  /// The weight that the bind pose contains already: a weight w moves the vertices by w - defaultWeight.
  float defaultWeight = 0.0F;
  std::vector<MorphOffset> offsets;  ///< only of vertices that move, in ascending order
};

/// Keys of the weights of consecutive targets in one clip.
struct MorphWeightTrack {
  int firstTarget = 0;                                         ///< index into Morphs::targets
  int targetCount = 0;                                         ///< consecutive ones
  KeyInterpolation interpolation = KeyInterpolation::kLinear;  ///< between two keys
  std::vector<double> times;                                   ///< [s], strictly increasing, at least one
  /// keyCount x targetCount; for cubic splines each key has targetCount in-tangents, values and out-tangents, in this
  /// order, as in glTF 2.0 (https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html, appendix C)
  std::vector<float> values;
};

/// Morph targets over the vertices of a character's mesh. What a weight is good for is told by Expressions.
struct Morphs {
  std::vector<MorphTarget> targets;  ///< in the order of the file
  std::vector<std::vector<MorphWeightTrack>>
      clips;  ///< one list for each clip of the file, empty if it moves no target
};

/// Samples the weights of a clip. Before its first key a track has the first value, after its last key the last value.
/// Does not allocate memory.
/// @param tracks         one element of Morphs::clips
/// @param time           [s]
/// @param targetWeights  one for each target; those without a track are not changed
void sampleMorphWeights(std::span<const MorphWeightTrack> tracks, double time, std::span<float> targetWeights);

/// The shape of the mesh before skinning. Does not allocate memory; takes time only for targets that are not at their
/// default weight.
/// @param targetWeights  one for each target, any finite value
/// @param bindPositions  [m], model space
/// @param bindNormals    unit length or zero; may be empty
/// @param positions      as many as bindPositions, written [m]
/// @param normals        as many as bindNormals, written: unit length where a target moves them
void applyMorphs(const Morphs& morphs, std::span<const float> targetWeights, std::span<const Vec3> bindPositions,
                 std::span<const Vec3f> bindNormals, std::span<Vec3> positions, std::span<Vec3f> normals);

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
