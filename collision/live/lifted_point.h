#pragma once

#include "acd/decomposition.h"
#include "skinning/character.h"

#include <span>
#include <vector>

namespace lorica {

/// The contribution of one bone to a lifted point: worldFromModel * moment + weight * translation of worldFromModel.
struct LiftedTerm {
  JointIndex joint = 0;        ///< that moves the point
  Vec3 moment = Vec3::Zero();  ///< sum of (blend weight x bind position) [m], model space
  double weight = 0.0;         ///< sum of blend weights; over all terms of a point they sum to 1
};

/// A point of the body as a linear function of the bones' matrices: one constant 4-vector (moment, weight) for each
/// bone that moves it, joints ascending. For a mesh vertex this is linear blend skinning, to which
/// a shape adds terms of weight 0. A cut point is a fixed blend
/// of earlier points, so it can be lifted too, which removes the recursion.
using LiftedPoint = std::vector<LiftedTerm>;

/// Lifts every point of a decomposition: vertices, then cut points, pointCount() of them.
/// @param decomposition  made from the character's mesh
[[nodiscard]] std::vector<LiftedPoint> liftPoints(const Character& character, const Decomposition& decomposition);

/// Position of a lifted point [m]. The scalar reference of LiftedPart.
/// @param worldFromModel  for each joint the transform from the bind pose, worldFromJoint * jointFromModel
[[nodiscard]] Vec3 positionOf(const LiftedPoint& point, std::span<const Affine3> worldFromModel);

/// Position of a lifted point in the bind pose [m], model space.
[[nodiscard]] Vec3 bindPositionOf(const LiftedPoint& point);

/// The points of a part that can be on its hull in some pose, ascending. The others are inside it in every pose:
///   - cut points between points that are in the part themselves, for example where parts were joined again;
///   - points inside the hull of others that follow the same bones with the same weights: one affine map moves them
///   all.
/// @param lifted    of all points of the decomposition
/// @param attached  vertices that the part has to cover besides its own, see collision/live/attached_vertices.h
[[nodiscard]] std::vector<PointIndex> hullCandidates(const Decomposition& decomposition, const Part& part,
                                                     std::span<const LiftedPoint> lifted,
                                                     std::span<const PointIndex> attached = {});

}  // namespace lorica
