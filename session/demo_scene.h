#pragma once

#include "collision/world/world.h"

#include <cstdint>

namespace lorica {

/// Of the demo, and of whoever plays without another scene.
inline constexpr std::uint64_t kDemoSeed = 1;

/// A world to play in: about twenty boxes and balls around a person who stands at the origin and faces +Z. Two towers
/// stand within reach of hands and feet, in front and at the left; the rest falls from 2 to 7 m around the person and
/// onto them in the first two seconds. Nothing starts where a person in T-pose stands, and what would start inside
/// another avatar goes out of its way, see World::Settings::makesRoom.
/// @param seed  places, sizes, attitudes and colours of what falls; the same seed gives the same world everywhere
[[nodiscard]] World makeDemoWorld(std::uint64_t seed);

}  // namespace lorica
