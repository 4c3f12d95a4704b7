#pragma once

#include <cstdint>

namespace lorica {

/// The finalizer of SplitMix64 (Steele, Lea and Flood 2014): a well-mixed value for every 64-bit number.
[[nodiscard]] constexpr std::uint64_t mixedBits(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}
/// The top 53 bits as a number in [0, 1), a multiple of 2^-53.
[[nodiscard]] constexpr double unitOf(std::uint64_t bits) {
  return (bits >> 11) * 0x1p-53;
}

/// Random numbers without state: one for each counter and seed.
[[nodiscard]] constexpr std::uint64_t randomBits(std::uint64_t seed, std::uint64_t counter) {
  return mixedBits(seed * 0xd1342543de82ef95u + (counter + 1) * 0x9e3779b97f4a7c15u);
}
/// Uniform in [0, 1).
[[nodiscard]] constexpr double randomUnit(std::uint64_t seed, std::uint64_t counter) {
  return unitOf(randomBits(seed, counter));
}

/// A random number generator that gives the same sequence on every machine and with every standard library: SplitMix64.
/// The same seed gives the same sequence.
class RandomNumbers {
 public:
  /// The same seed gives the same numbers on every machine
  explicit RandomNumbers(std::uint64_t seed) : state_(seed) {}

  /// Uniform over all 64-bit numbers.
  std::uint64_t bits() { return mixedBits(state_ += 0x9e3779b97f4a7c15u); }

  /// Uniform in [0, 1).
  double unit() { return unitOf(bits()); }

  /// Uniform from `min` to `max`.
  double between(double min, double max) { return min + (max - min) * unit(); }

 private:
  std::uint64_t state_;
};

}  // namespace lorica
