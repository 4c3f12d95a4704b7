#pragma once

#include <cstdint>

namespace lorica {

/// A sequence of random numbers that is the same on every machine and with every standard library: SplitMix64 (Steele,
/// Lea and Flood 2014). Same seed, same sequence.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : state_(seed) {}

  /// Uniform over all 64-bit numbers.
  std::uint64_t bits() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  /// Uniform in [0, 1), a multiple of 2^-53.
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

  /// Uniform from `least` to `most`.
  double between(double least, double most) { return least + (most - least) * unit(); }

 private:
  std::uint64_t state_;
};

}  // namespace lorica
