#pragma once

#include "viewer/image.h"

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

/// Draws lines of text (separated by '\n'; '\t' goes to the next tab stop) with OpenCV's Hershey strokes, which need no
/// font file. They know ASCII; common typographic signs are replaced by their ASCII likeness and the rest by '?'.
/// @param lineHeight  distance of two base lines [pixels], at least 6
[[nodiscard]] TextMask drawText(std::string_view text, int lineHeight);

/// Dark text on a translucent light plate with round corners; RGB is multiplied by alpha already.
/// @param lineHeight  [pixels]
[[nodiscard]] Image drawTextPanel(std::string_view text, int lineHeight);

/// The text in lines that are at most so wide as drawText draws them: broken at blanks, and words that are too long cut
/// off, with two dots for what is missing.
/// @param width  [pixels]
[[nodiscard]] std::string fittedText(std::string_view text, int lineHeight, int width);

/// What drawText can draw of UTF-8 text.
[[nodiscard]] std::string drawableText(std::string_view utf8);

}  // namespace lorica
