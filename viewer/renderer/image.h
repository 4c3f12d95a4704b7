#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lorica {

/// 8-bit sRGB image, row 0 at the top, RGBA interleaved.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;

  /// Of an image of this size.
  [[nodiscard]] std::size_t byteCount() const { return std::size_t{4} * width * height; }
  [[nodiscard]] std::uint8_t* pixel(int x, int y) { return rgba.data() + 4 * (std::size_t{1} * y * width + x); }
};

}  // namespace lorica
