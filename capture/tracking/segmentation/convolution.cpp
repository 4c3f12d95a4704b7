#include "capture/tracking/segmentation/convolution.h"

namespace lorica {
namespace {

constexpr int kBlock = 8;  // outputs whose weights lie side by side

int filledUp(int channels) {
  return (channels + kBlock - 1) / kBlock * kBlock;
}

int pairsOf(const ConvolutionShape& shape) {
  if (shape.kind == ConvolutionKind::kDepthwise) return static_cast<int>(kDepthwisePairs.size());
  return (shape.kind == ConvolutionKind::kDense ? 9 : 1) * filledUp(shape.in) / 2;
}

}  // namespace

int ConvolutionShape::taps() const {
  switch (kind) {
    case ConvolutionKind::kDense:
      return 9 * in;
    case ConvolutionKind::kDepthwise:
      return 9;
    case ConvolutionKind::kPointwise:
      break;
  }
  return in;
}

Convolution::Convolution(const ConvolutionShape& layer, std::span<const std::int32_t> bias,
                         std::span<const std::uint8_t> shifts, std::span<const std::int8_t> inFile)
    : shape(layer),
      in(filledUp(layer.in)),
      out(filledUp(layer.out)),
      offset(out),
      shift(out),
      weights(std::size_t{2} * pairsOf(layer) * out) {
  for (int o = 0; o < shape.out; ++o) {
    shift[o] = shifts[o];
    offset[o] = bias[o] + (shifts[o] > 0 ? 1 << (shifts[o] - 1) : 0);
  }

  const int pairs = pairsOf(shape);
  for (int o = 0; o < shape.out; ++o) {
    for (int tap = 0; tap < 2 * pairs; ++tap) {
      const int pair = tap / 2, second = tap % 2;
      std::int16_t& to = weights.data()[((o / kBlock * pairs + pair) * kBlock + o % kBlock) * 2 + second];
      if (shape.kind == ConvolutionKind::kDepthwise) {
        const int pixel = kDepthwisePairs[pair][second];
        if (pixel >= 0) to = inFile[pixel * shape.out + o];  // NOLINT(bugprone-signed-char-misuse): a number
      } else {
        const int pixel = tap / in, channel = tap % in;
        // NOLINTNEXTLINE(bugprone-signed-char-misuse): a number
        if (channel < shape.in) to = inFile[(pixel * shape.in + channel) * shape.out + o];
      }
    }
  }
}

}  // namespace lorica
