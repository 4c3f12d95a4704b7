#pragma once

#include "collision/world/prop.h"

#include <cstddef>

namespace lorica {

class SceneElement;
struct SceneFile;

/// Reads the shape of a chain and adds its links to the scene: capsules or planks end to end. Neighbours are linked to
/// each other, and the first, or both ends, to the world. Internal to scene_file.cpp.
/// @param link      with mass, friction, restitution and colour
/// @param maxProps  no link is added once there are more props than this
void addChain(SceneElement& element, Prop link, std::size_t maxProps, SceneFile& scene);

}  // namespace lorica
