#pragma once

#include "acd/decomposition_file.h"
#include "collision/world/world.h"
#include "skinning/character.h"
#include "skinning/springs/spring_bones.h"

#include <cstdint>
#include <optional>

namespace lorica {

/// Exact hash of everything in a character that poses and hulls depend on.
[[nodiscard]] std::uint64_t hashOf(const Character& character);
/// Exact hash of all springs, colliders and constraints.
[[nodiscard]] std::uint64_t hashOf(const SpringBones& springs);
/// 0 if there is none.
[[nodiscard]] std::uint64_t hashOf(const std::optional<HullCover>& cover);
[[nodiscard]] std::uint64_t hashOf(const std::optional<TrainingRange>& training);
/// Exact hash of all props with their meshes, physical properties and poses, and of the particles.
[[nodiscard]] std::uint64_t hashOf(const World& world);

}  // namespace lorica
