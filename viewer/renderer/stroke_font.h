#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace lorica {

/// Height of capitals in OpenCV's stroke font (Hershey, simplex) at scale 1 [pixels].
inline constexpr double kStrokeCapHeight = 22.0;

/// How text is drawn: larger than needed, then downsampled by area averaging, because OpenCV's anti-aliasing of small
/// strokes is uneven.
struct StrokeStyle {
  int oversampling = 4;
  double scale = 1.0;       ///< of the font, in the oversampled picture
  int thickness = 1;        ///< of a stroke, in the oversampled picture [pixels]
  bool antiAliased = true;  ///< in the oversampled picture
};

/// A line of ASCII text and its start position in the oversampled picture [pixels].
struct StrokeLine {
  std::string text;
  int x = 0;
  int baseline = 0;
};

/// Width of a line in the oversampled picture [pixels].
[[nodiscard]] int strokeWidth(const std::string& text, const StrokeStyle& style);

/// @param coverage  output, 0 to 255, width x height of the final picture, rows from the top
void drawStrokes(std::span<const StrokeLine> lines, const StrokeStyle& style, int width, int height,
                 std::span<std::uint8_t> coverage);

}  // namespace lorica
