#pragma once

#include "viewer/renderer/scene.h"

#include <optional>
#include <string_view>

namespace lorica {

/// Of a picture or a window [pixels].
struct CanvasSize {
  int width = 1280, height = 720;
};
inline constexpr int kSmallestSide = 16, kLargestSide = 4096;

/// "640x360", "portrait" (1080x1920) or "square" (1080x1080); none for any other text, or a side that is not possible.
[[nodiscard]] std::optional<CanvasSize> pictureSizeOf(std::string_view text);

/// Sets what is behind the avatars: "#00ff00" or "transparent", both without the ground; empty = as it is.
/// @return false for any other text
[[nodiscard]] bool setBackground(std::string_view text, SceneOptions& show);

}  // namespace lorica
