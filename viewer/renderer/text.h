#pragma once

#include "viewer/renderer/image.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// Characters of UTF-8 text. Damaged bytes become U+FFFD, control characters other than '\n' and '\t' blanks.
[[nodiscard]] std::u32string charactersOf(std::string_view utf8);

// Characters are drawn with DejaVu Sans, and what it lacks with the first of the other fonts (Noto Sans CJK, Droid)
// that is installed and has it. They are looked for in /usr/share/fonts, or in the folder that LORICA_FONTS names.
// Without any, nothing is drawn, and standard error says so once.

/// The file of the font that draws a character, for other libraries; empty = there is no font. Valid until the program
/// ends.
[[nodiscard]] std::string_view fontFileFor(char32_t character);

/// Anti-aliased text: coverage 0 to 255, row 0 at the top.
struct TextMask {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> coverage;
};

/// Draws lines of UTF-8 text (separated by '\n'; '\t' moves to the next tab stop).
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
