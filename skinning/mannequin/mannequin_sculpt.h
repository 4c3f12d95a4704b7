#pragma once

#include "geometry/math.h"

#include <span>

namespace lorica {

/// Adds detail finer than the control cage: muscles, face, knees. Moves points of the left half of the mannequin,
/// x >= 0; points with x == 0 stay in the plane of symmetry.
void sculptMannequin(std::span<Vec3> points);

}  // namespace lorica
