#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace lorica {

/// OpenCV's font of strokes (Hershey, simplex). Its capitals are this high at scale 1 [pixels].
inline constexpr double kStrokeCapHeight = 22.0;

/// How text is drawn: larger than wanted, then shrunk by area, because OpenCV's own anti-aliasing of small strokes is
/// uneven.
struct StrokeStyle {
  int oversampling = 4;
  double scale = 1.0;       ///< of the font, in the larger picture
  int thickness = 1;        ///< of a stroke, in the larger picture [pixels]
  bool antiAliased = true;  ///< in the larger picture
};

/// A line of ASCII text and where it begins, in the larger picture [pixels].
struct StrokeLine {
  std::string text;
  int x = 0;
  int baseline = 0;
};

/// Width of a line in the larger picture [pixels].
[[nodiscard]] int strokeWidth(const std::string& text, const StrokeStyle& style);

/// @param coverage  0 to 255, width x height of the picture that is wanted, rows from the top; written
void drawStrokes(std::span<const StrokeLine> lines, const StrokeStyle& style, int width, int height,
                 std::span<std::uint8_t> coverage);

}  // namespace lorica
