#pragma once

#include <array>
#include <cstdint>

namespace lorica {

/// This many 3 x 3 matrices side by side: entry 3 * row + column of each.
struct alignas(64) MatrixBlock {
  static constexpr std::size_t kMatrices = 8;
  std::array<std::array<double, kMatrices>, 9> entry{};
};

/// Times the cubed norm of a covariance: below this determinant its points are nearly flat, or mirrored.
inline constexpr double kThinDeterminant = 1e-4;

/// First attempt of fitRotation(), for several covariances at once, with vector instructions: a few Newton steps from
/// nearby rotations. Internal. The same on every instruction set, independent of the neighbouring matrices.
/// @param rotations  in: previous ones; out: the fits that were found
/// @return bit k: covariance k is not nearly flat, and its fit was found
[[nodiscard]] std::uint32_t fitNearby(const MatrixBlock& covariances, MatrixBlock& rotations);

}  // namespace lorica
