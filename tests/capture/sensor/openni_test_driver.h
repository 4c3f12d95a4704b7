#pragma once

#include <cstdint>

namespace lorica::test {

/// Depth of the test driver's camera in frame n: the frame number in the first pixel, then values that vary everywhere.
constexpr std::uint16_t openNiTestDepth(int n, int pixel) {
  return static_cast<std::uint16_t>(pixel == 0 ? 1000 + n : 600 + (pixel * 7 / 5 + 11 * n) % 3000);
}

}  // namespace lorica::test
