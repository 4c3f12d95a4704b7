#pragma once

#include "acd/decomposition.h"
#include "collision/live/choose_cover.h"
#include "export/rigid_colliders.h"

#include <vector>

namespace lorica::test {

/// A square bar along Y, 0.2 m wide and 2 m high, of 20 rings of corners. The lower half follows "lower", whose joint
/// is at the floor, the upper half "upper", whose joint is at 1 m; from 0.8 to 1.2 m weights blend linearly.
[[nodiscard]] Character stickFigure();

/// The whole mesh as one part.
[[nodiscard]] Decomposition onePart(const Character& character);

/// Poses of the stick figure: the upper bone bends about X by each of these angles, and the figure is moved and turned.
[[nodiscard]] std::vector<Affine3> bentPoses(const Character& character, const std::vector<double>& angles);

/// Its colliders, made from such poses.
[[nodiscard]] std::vector<RigidCollider> collidersIn(const Character& character, const std::vector<double>& angles);

}  // namespace lorica::test
