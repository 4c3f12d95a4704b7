#pragma once

#include <cstdint>
#include <vector>

namespace lorica {

/// 8-bit sRGB image, row 0 at the top, RGBA interleaved.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

}  // namespace lorica
