#pragma once

#include "collision/live/lifted_part.h"

namespace lorica {

// What a LiftedPart computes in every frame, with vector instructions. Everything here is internal. Results are the
// same on every instruction set.

/// The sum over bones of worldFromModel, about an origin in the world, times the bone's constants.
/// @param constants  one for each joint
[[nodiscard]] FourColumns<double> sumOverBones(std::span<const Affine3> worldFromModel, const Vec3& origin,
                                               std::span<const JointIndex> joints,
                                               std::span<const FourColumns<double>> constants);

/// Parameters of a part's view of its bones: stepsFromWorld * (worldFromModel about a center in the model - origin).
struct BoneView {
  Mat3 stepsFromWorld;
  Vec3 origin;         ///< world
  Vec3 center;         ///< model
  float radius = 0;    ///< max distance of the points from the center [m]
  float still = 0.0F;  ///< motion of points up to this counts as none [steps]
};

/// Writes the part's view of its bones, unless no point would move.
/// @param matrices  one for each joint; in: the last view, NaN at first
/// @return whether they were written
bool viewBones(std::span<const Affine3> worldFromModel, const BoneView& view, std::span<const JointIndex> joints,
               std::span<FourColumns<float>> matrices);

/// The inner loop of LiftedPart::evaluate().
/// @param matrices  of the part's bones
/// @return the largest absolute coordinate
[[nodiscard]] float evaluateLifted(std::span<const LiftedPart::Group> groups, std::span<const std::uint32_t> groupBones,
                                   const LiftedPart::Lane* lanes, const FourColumns<float>* matrices, PointRow* rows);

/// Index of the row farthest along a direction; of several, the first. The same on every instruction set.
/// @param rows  at least one
[[nodiscard]] std::int32_t farthestRow(std::span<const PointRow> rows, const Vec3f& direction);

}  // namespace lorica
