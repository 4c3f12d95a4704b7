#pragma once

#include "collision/world/world.h"
#include "viewer/renderer/scene.h"

namespace lorica {

/// A camera that shows what a scene is about: the same one, moved back until the props that can move and are near its
/// target are in the middle of the picture, between the panels of a window.
[[nodiscard]] Camera framing(const Camera& start, const World& world);

}  // namespace lorica
