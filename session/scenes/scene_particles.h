#pragma once

#include "collision/particles/particles.h"
#include "session/scenes/scene_element.h"

#include <optional>

namespace lorica {

/// Reads "grains" or "water" of a scene, which has at most one of them. Internal to readScene().
/// @param root      the scene, which records errors
/// @param settings  with the scene's gravity and floor
[[nodiscard]] std::optional<ParticleSettings> readParticles(SceneElement& root, const ParticleSettings& settings);

}  // namespace lorica
