#pragma once

#include "capture/tracking/segmentation/feature_map.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

enum class ConvolutionKind {
  kDense,      ///< 3x3, of all channels
  kDepthwise,  ///< 3x3, of each channel by itself
  kPointwise,  ///< 1x1, of all channels
};

/// What a convolution is, but for its numbers.
struct ConvolutionShape {
  ConvolutionKind kind;
  int in, out;            ///< channels
  bool linear = false;    ///< any result, else only 0 to 4095
  bool residual = false;  ///< the input of the block is added

  /// Weights from which one result is computed.
  [[nodiscard]] int taps() const;
  [[nodiscard]] int weightCount() const { return taps() * out; }
};

/// Pairs of taps of a depthwise convolution, as row * 3 + column: the upper two of each column, then the lowest row.
/// The last pair has one only.
inline constexpr std::array<std::array<int, 2>, 5> kDepthwisePairs = {{{0, 3}, {1, 4}, {2, 5}, {6, 7}, {8, -1}}};

/// A convolution of integers: for each output, (bias + sum of weight * input) / 2^shift, rounded, plus the residual.
/// Its numbers lie as vector instructions take them. Channels are filled up to a multiple of 8 with weights that are 0.
struct Convolution {
  /// @param bias     for each output, at most 2^28 in size
  /// @param shifts   for each output, 0 to 20
  /// @param inFile   the weights in the order of the file
  Convolution(const ConvolutionShape& of, std::span<const std::int32_t> bias, std::span<const std::uint8_t> shifts,
              std::span<const std::int8_t> inFile);

  ConvolutionShape shape;
  int in, out;                       ///< channels, multiples of 8
  std::vector<std::int32_t> offset;  ///< bias, and half of what the shift divides by
  std::vector<std::int32_t> shift;
  /// For each 8 outputs, for each pair of taps: two weights of each output. Taps are in the order in which rows of the
  /// input lie in memory; those of a depthwise convolution as kDepthwisePairs says.
  AlignedNumbers weights;
};

}  // namespace lorica
