#include "export/engines.h"

#include <algorithm>
#include <array>

namespace lorica {

std::span<const Engine> engines() {
  static constexpr std::array<Engine, 6> kEngines = {{
      {"unity", 255, "a convex MeshCollider has at most 255 vertices (com.unity.cv.synthetichumans#8)"},
      {"unreal", 32, "8 to 32 vertices are usual; names begin with UCX_", "UCX_"},
      {"physx", 60, "60 vertices on the GPU (CoACD#10)"},
      {"mujoco", 0, "collides the hull of any mesh"},
      {"jolt", 256, "ConvexHullShape::cMaxPointsInHull"},
      {"godot", 0, "no limit; names end with -convcolonly", "", "-convcolonly"},
  }};
  return kEngines;
}

std::optional<Engine> engineNamed(std::string_view name) {
  const auto found = std::ranges::find(engines(), name, &Engine::name);
  return found == engines().end() ? std::nullopt : std::optional(*found);
}

}  // namespace lorica
