#pragma once

#include "collision/particles/particles.h"
#include "collision/world/prop.h"
#include "session/scenes/scene_element.h"

#include <cstddef>
#include <optional>

namespace lorica {

struct SceneFile;

/// Reads the shape of a chain and adds its links to the scene: capsules or planks end to end. Neighbours are linked to
/// each other, and the first, or both ends, to the world. Internal to scene_file.cpp.
/// @param link      with mass, friction, restitution and colour
/// @param maxProps  no link is added once there are more props than this
void addChain(SceneElement& element, Prop link, std::size_t maxProps, SceneFile& scene);

/// Reads "grains" or "water" of a scene, which has at most one of them. Internal to readScene().
/// @param root      the scene, which records errors
/// @param settings  with the scene's gravity and floor
[[nodiscard]] std::optional<ParticleSettings> readParticles(SceneElement& root, const ParticleSettings& settings);

}  // namespace lorica
