#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <string_view>
#include <vector>

namespace lorica::test {

/// The parts of a network's file that belong to one convolution.
struct SlowConvolution {
  char kind;    ///< '3': 3x3 of all channels, 'd': 3x3 of each channel, '1': 1x1
  int in, out;  ///< channels
  std::vector<std::int32_t> bias;
  std::vector<std::uint8_t> shift;
  std::vector<std::int8_t> weights;
};

/// A PersonNetwork as simple as it can be, to compare with.
class SlowNetwork {
 public:
  /// Random weights. With `size` 1 the features are of the size of a trained network's; up to 4, many reach the bounds.
  SlowNetwork(std::mt19937_64& random, double size);

  [[nodiscard]] std::vector<std::uint8_t> file() const;
  [[nodiscard]] std::vector<std::int16_t> run(std::span<const std::uint16_t> depthMm,
                                              std::span<const std::int16_t> heightMm, bool floorKnown) const;

  std::vector<SlowConvolution> convolutions;
};

}  // namespace lorica::test
