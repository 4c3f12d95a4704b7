#pragma once

/// Random numbers that are the same on every machine and need no state. Internal to score().

#include <cstdint>

namespace lorica {

/// A well-mixed 64-bit value for each counter and seed (the finalizer of SplitMix64).
[[nodiscard]] inline std::uint64_t randomBits(std::uint64_t seed, std::uint64_t counter) {
  std::uint64_t z = seed * 0xd1342543de82ef95u + (counter + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// Uniform in [0, 1), a multiple of 2^-53.
[[nodiscard]] inline double randomUnit(std::uint64_t seed, std::uint64_t counter) {
  return static_cast<double>(randomBits(seed, counter) >> 11) * 0x1p-53;
}

}  // namespace lorica
