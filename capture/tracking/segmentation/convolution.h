#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Numbers of 16 bits, at first 0, that start on a cache line whatever the allocator.
class AlignedNumbers {
 public:
  explicit AlignedNumbers(std::size_t count) : lines_((count + kOfLine - 1) / kOfLine) {}

  [[nodiscard]] std::int16_t* data() { return reinterpret_cast<std::int16_t*>(lines_.data()); }
  [[nodiscard]] const std::int16_t* data() const { return reinterpret_cast<const std::int16_t*>(lines_.data()); }

 private:
  static constexpr std::size_t kOfLine = 32;
  struct alignas(2 * kOfLine) Line {
    std::array<std::int16_t, kOfLine> numbers{};
  };

  std::vector<Line> lines_;
};

/// An image with several numbers for each pixel, its channels, which lie side by side. Around it lies a border of one
/// pixel that is always 0.
class FeatureMap {
 public:
  /// @param channels  a multiple of 8
  FeatureMap(int width, int height, int channels)
      : width_(width),
        height_(height),
        channels_(channels),
        numbers_(static_cast<std::size_t>(width + 2) * (height + 2) * channels) {}

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int channels() const { return channels_; }
  /// Numbers from one row to the next.
  [[nodiscard]] std::ptrdiff_t stride() const { return std::ptrdiff_t{1} * (width_ + 2) * channels_; }
  /// First pixel of a row. @param y  from -1, the border, to height()
  [[nodiscard]] std::int16_t* row(int y) { return numbers_.data() + offset(y); }
  [[nodiscard]] const std::int16_t* row(int y) const { return numbers_.data() + offset(y); }

 private:
  [[nodiscard]] std::ptrdiff_t offset(int y) const { return (y + 1) * stride() + channels_; }

  int width_, height_, channels_;
  AlignedNumbers numbers_;
};

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
  Convolution(const ConvolutionShape& layer, std::span<const std::int32_t> bias, std::span<const std::uint8_t> shifts,
              std::span<const std::int8_t> inFile);

  ConvolutionShape shape;
  int in, out;                       ///< channels, multiples of 8
  std::vector<std::int32_t> offset;  ///< bias, and half of what the shift divides by
  std::vector<std::int32_t> shift;
  /// For each 8 outputs, for each pair of taps: two weights of each output. Taps are in the order in which rows of the
  /// input lie in memory; those of a depthwise convolution as kDepthwisePairs says.
  AlignedNumbers weights;
};

// What a PersonNetwork computes, with vector instructions. Results are the same on every instruction set.

/// What a network is told about some pixels that lie side by side, each number from 0 to 4095.
struct PixelInputs {
  std::span<std::int16_t> depth;     ///< 512 is 1 m
  std::span<std::int16_t> measured;  ///< 1024, or 0
  std::span<std::int16_t> height;    ///< 1024 is 1 m, from half a metre below the floor on
};

/// @param depthMm   a multiple of 8 pixels; 0 = nothing measured
/// @param heightMm  over the floor, used where it is known and something is measured
void measure(std::span<const std::uint16_t> depthMm, std::span<const std::int16_t> heightMm, bool floorKnown,
             const PixelInputs& to);

/// @param block  input of the block that this convolution ends, which is added if its shape says so
/// @param to     of the same size as `from`, at least 5 pixels wide; neither `from` nor `block`
void convolve(const Convolution& convolution, const FeatureMap& from, const FeatureMap& block, FeatureMap& to);

/// Each pixel is the largest of four, in each channel.
/// @param to  half as wide and high as `from`
void halve(const FeatureMap& from, FeatureMap& to);

/// Adds each pixel of an image to four of another one, whose numbers stay between 0 and 4095.
/// @param to  twice as wide and high as `from`
void addDoubled(const FeatureMap& from, FeatureMap& to);

}  // namespace lorica
