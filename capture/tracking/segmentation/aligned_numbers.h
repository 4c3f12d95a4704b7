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

}  // namespace lorica
