#pragma once

namespace lorica {

/// Points for supportIndex() come in whole blocks; what a block has too much repeats one of the points.
inline constexpr int kSupportBlock = 16;

/// Which point is farthest along a direction; of several, the first. The same on every machine: vector instructions of
/// any width compare the same roundings.
/// @param x, y, z  coordinates of `count` points
/// @param count    above 0, a multiple of kSupportBlock
[[nodiscard]] int supportIndex(const float* x, const float* y, const float* z, int count, float directionX,
                               float directionY, float directionZ);

}  // namespace lorica
