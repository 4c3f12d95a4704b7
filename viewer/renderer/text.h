#pragma once

#include "viewer/renderer/image.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// Anti-aliased text: coverage 0 to 255, row 0 at the top.
struct TextMask {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> coverage;
};

/// Draws lines of UTF-8 text (separated by '\n'; '\t' moves to the next tab stop) with the fonts of font.h.
/// @param lineHeight  distance of baselines [pixels], at least 6
[[nodiscard]] TextMask drawText(std::string_view text, int lineHeight);

/// Dark text on a translucent light plate with round corners; RGB is premultiplied by alpha.
/// @param lineHeight  [pixels]
[[nodiscard]] Image drawTextPanel(std::string_view text, int lineHeight);

/// Wraps text to a maximum width as drawn by drawText(): lines break at blanks, and words that are too long are
/// truncated, with two dots at the end.
/// @param width  [pixels]
[[nodiscard]] std::string fittedText(std::string_view text, int lineHeight, int width);

}  // namespace lorica
