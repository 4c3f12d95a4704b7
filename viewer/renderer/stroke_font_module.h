#pragma once

#include "viewer/renderer/stroke_font.h"

namespace lorica {

/// OpenCV implementation of stroke_font.h, in a separate module so that OpenCV is only loaded to draw text.
struct StrokeFontModule {
  int (*strokeWidth)(const std::string& text, const StrokeStyle& style);
  void (*drawStrokes)(std::span<const StrokeLine> lines, const StrokeStyle& style, int width, int height,
                      std::span<std::uint8_t> coverage);
};

/// Name of the module's symbol.
inline constexpr const char* kStrokeFontSymbol = "loricaStrokeFont";

}  // namespace lorica
