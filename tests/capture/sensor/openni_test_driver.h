#pragma once

#include <cstdint>

namespace lorica::test {

/// What the test driver's camera sees in frame n: the number in the first pixel, then something that changes all over.
constexpr std::uint16_t openNiTestDepth(int n, int pixel) {
  return static_cast<std::uint16_t>(pixel == 0 ? 1000 + n : 600 + (pixel * 7 / 5 + 11 * n) % 3000);
}

}  // namespace lorica::test
