#include "tests/peers/likeness.h"

#include "tests/viewer/renderer/picture_error.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace lorica::test {
namespace {

constexpr int kWhollyWrong = 48;  // a greater difference in a channel
constexpr int kCovered = 120;     // half of the samples of a pixel, however that is rounded

bool isWhole(const MaskedPicture& p, int width, int height) {
  const auto whole = [&](const Image& image) {
    return image.width == width && image.height == height &&
           image.rgba.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
  };
  return width > 0 && height > 0 && whole(p.picture) && whole(p.mask);
}

}  // namespace

Likeness likenessOf(const MaskedPicture& a, const MaskedPicture& b) {
  Likeness result;
  const int width = a.picture.width, height = a.picture.height;
  if (!isWhole(a, width, height) || !isWhole(b, width, height)) return result;
  result.shown = {width, height, std::vector<std::uint8_t>(a.picture.rgba.size(), 255)};
  int common = 0, either = 0, wrong = 0;
  double sum = 0.0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t at = (static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)) * 4;
      const bool inA = a.mask.rgba[at] >= kCovered, inB = b.mask.rgba[at] >= kCovered;
      if (!inA && !inB) continue;
      ++either;
      std::array<int, 3> color = inA ? std::array{40, 90, 255} : std::array{255, 210, 0};
      if (inA && inB) {
        ++common;
        int total = 0;
        for (std::size_t c = 0; c < 3; ++c) total += std::abs(a.picture.rgba[at + c] - b.picture.rgba[at + c]);
        sum += total / 3.0;
        const bool bad = std::max(differenceNearby(a.picture, b.picture, x, y),
                                  differenceNearby(b.picture, a.picture, x, y)) > kWhollyWrong;
        wrong += bad;
        const int grey = std::min(40 + total, 255);
        color = bad ? std::array{230, 0, 0} : std::array{grey, grey, grey};
      }
      for (std::size_t c = 0; c < 3; ++c) result.shown.rgba[at + c] = static_cast<std::uint8_t>(color[c]);
    }
  }
  if (common == 0) return result;
  result.silhouettes = static_cast<double>(common) / either;
  result.wrong = static_cast<double>(wrong) / common;
  result.meanDifference = sum / common;
  return result;
}

}  // namespace lorica::test
