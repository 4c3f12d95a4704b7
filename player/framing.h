#pragma once

#include "collision/world/world.h"
#include "viewer/renderer/picture_area.h"

namespace lorica {

/// From where a camera looks unless the user says otherwise: 35 degrees from where the avatar faces, on its right, so
/// that a kick is visible; slightly from above.
[[nodiscard]] Vec3 usualDirection(double facing);

/// The initial camera of a window: it looks at the avatars and shows what the scene is about, the props that can move
/// and are near them, between the panels.
/// @param avatars  around them @param facing  azimuth to which they face [rad]
[[nodiscard]] Camera windowCamera(const Aabb& avatars, double facing, const World& world);

}  // namespace lorica
