#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

namespace lorica {

/// What an engine takes as a convex collider.
struct Engine {
  std::string_view name;          ///< as typed: "unity"
  int maxVertices = 0;            ///< of a convex hull; 0 = no limit
  std::string_view prefix = "";   ///< of the names of nodes with a collider
  std::string_view postfix = "";  ///< the same, at the end
};

/// All engines, in the order of the documentation.
inline constexpr std::array<Engine, 6> kEngines = {{
    {"unity", 255},          // a convex MeshCollider has at most 255 vertices (com.unity.cv.synthetichumans#8)
    {"unreal", 32, "UCX_"},  // 8 to 32 vertices are usual
    {"physx", 60},           // on the GPU (CoACD#10)
    {"mujoco"},              // collides the hull of any mesh
    {"jolt", 256},           // ConvexHullShape::cMaxPointsInHull
    {"godot", 0, "", "-convcolonly"},  // no limit
}};

/// Of the hulls for an engine that is not named or takes any.
inline constexpr int kUsualVertices = 64;

/// None if no engine has this name.
[[nodiscard]] inline std::optional<Engine> engineNamed(std::string_view name) {
  const auto* found = std::ranges::find(kEngines, name, &Engine::name);
  return found == kEngines.end() ? std::nullopt : std::optional(*found);
}

}  // namespace lorica
