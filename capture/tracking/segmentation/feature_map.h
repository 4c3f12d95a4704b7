#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
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

}  // namespace lorica
