#pragma once

#include "viewer/stroke_font.h"

namespace lorica {

/// The functions of stroke_font.h as OpenCV does them: in a module, so that only what draws text loads OpenCV.
struct StrokeFontModule {
  int (*strokeWidth)(const std::string& text, const StrokeStyle& style);
  void (*drawStrokes)(std::span<const StrokeLine> lines, const StrokeStyle& style, int width, int height,
                      std::span<std::uint8_t> coverage);
};

/// What the module's constant is called.
inline constexpr const char* kStrokeFontSymbol = "loricaStrokeFont";

}  // namespace lorica
