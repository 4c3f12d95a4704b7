#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lorica {

/// 8-bit sRGB image, row 0 at the top, RGBA interleaved.
struct Image {
  int width = 0;                   ///< pixels
  int height = 0;                  ///< pixels
  std::vector<std::uint8_t> rgba;  ///< four bytes a pixel, row by row from the top; sRGB

  /// An image of this size whose bytes, alpha too, all have `value`.
  [[nodiscard]] static Image filled(int width, int height, std::uint8_t value = 0) {
    return {width, height, std::vector<std::uint8_t>(std::size_t{4} * width * height, value)};
  }
  /// Of an image of this size.
  [[nodiscard]] std::size_t byteCount() const { return std::size_t{4} * width * height; }
  /// Four bytes; from the upper left corner.
  [[nodiscard]] std::uint8_t* pixel(int x, int y) { return rgba.data() + 4 * (std::size_t{1} * y * width + x); }
};

}  // namespace lorica
