#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace lorica {

/// What an engine takes as a convex collider.
struct Engine {
  std::string_view name;          ///< as typed: "unity"
  int maxVertices = 0;            ///< of a convex hull; 0 = no limit
  std::string_view source;        ///< where the limit comes from
  std::string_view prefix = "";   ///< of the names of nodes with a collider
  std::string_view postfix = "";  ///< the same, at the end
};

/// Of the hulls for an engine that is not named or takes any.
inline constexpr int kUsualVertices = 64;

/// All engines, in the order of the documentation.
[[nodiscard]] std::span<const Engine> engines();
/// None if no engine has this name.
[[nodiscard]] std::optional<Engine> engineNamed(std::string_view name);

}  // namespace lorica
