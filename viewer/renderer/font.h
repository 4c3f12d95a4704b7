#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// Characters of UTF-8 text. Damaged bytes become U+FFFD, control characters other than '\n' and '\t' blanks.
[[nodiscard]] std::u32string charactersOf(std::string_view utf8);

// Characters are drawn with DejaVu Sans, and what it lacks with the first of the other fonts (Noto Sans CJK, Droid)
// that is installed and has it. They are looked for in /usr/share/fonts, or in the folder that LORICA_FONTS names.
// Without any, nothing is drawn, and standard error says so once.

/// The file of the font that draws a character, for other libraries; empty = there is no font. Valid until the program
/// ends.
[[nodiscard]] std::string_view fontFileFor(char32_t character);

/// @param em  size of the font [pixels]
[[nodiscard]] double advanceOf(char32_t character, double em);

/// Adds a character to a mask.
/// @param x, baseline  where it starts [pixels]
/// @param coverage     0 to 255, rows from the top
void drawCharacter(char32_t character, double em, double x, double baseline, int width, int height,
                   std::span<std::uint8_t> coverage);

}  // namespace lorica
