#pragma once

#include <array>
#include <cstdint>

namespace lorica {

/// So many 3 x 3 matrices side by side: entry 3 * row + column of each.
struct alignas(64) MatrixBlock {
  static constexpr std::size_t kMatrices = 8;
  std::array<std::array<double, kMatrices>, 9> entry{};
};

/// What fitRotation() tries first, for several covariances at once, with vector instructions: a few Newton steps from
/// rotations nearby. Internal. The same on every instruction set, whatever lies beside a matrix.
/// @param rotations  in: previous ones; out: the fits, where they were found
/// @return bit k: covariance k is far from flat, and its fit was found
[[nodiscard]] std::uint32_t fitNearby(const MatrixBlock& covariances, MatrixBlock& rotations);

}  // namespace lorica
