#pragma once

#include "collision/world/world.h"

#include <cstdint>

namespace lorica {

/// Seed of the default scene.
inline constexpr std::uint64_t kDemoSeed = 1;

/// The demo world: about twenty boxes and balls around a person who stands at the origin and faces +Z. Two towers stand
/// within reach of hands and feet, in front and at the left; the other props fall from 2 to 7 m around and onto the
/// person in the first two seconds. Nothing starts inside a person in T-pose; props that would start inside another
/// avatar are moved out of it, see World::Settings::resolvesOverlaps.
/// @param seed  for positions, sizes, rotations and colours of the falling props; the same on all platforms
[[nodiscard]] World makeDemoWorld(std::uint64_t seed);
/// The same under another gravity [m/s^2], for a person of another size.
/// @param scale  of sizes and positions
[[nodiscard]] World makeDemoWorldUnder(const Vec3& gravity, std::uint64_t seed, double scale = 1.0);

}  // namespace lorica
