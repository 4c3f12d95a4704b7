#pragma once

#include "geometry/math.h"
#include "skinning/skeleton.h"

#include <array>
#include <span>

namespace lorica {

/// What a LiftedPart computes from the matrices of its bones, with vector instructions. Everything here is internal.
/// Results are the same on every instruction set.

/// Four columns of x, y, z and a fourth number.
template <class Number>
struct alignas(4 * sizeof(Number)) FourColumns {
  std::array<std::array<Number, 4>, 4> column{};
};

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

}  // namespace lorica
