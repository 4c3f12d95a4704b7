#pragma once

namespace lorica {

/// Points for supportIndex() come in whole blocks; surplus entries of a block repeat one of the points.
inline constexpr int kSupportBlock = 16;

/// Index of the point farthest along a direction; of several, the first. The same on every machine: vector instructions
/// of any width compare identically rounded values.
/// @param x, y, z  coordinates of `count` points
/// @param count    above 0, a multiple of kSupportBlock
[[nodiscard]] int supportIndex(const float* x, const float* y, const float* z, int count, float directionX,
                               float directionY, float directionZ);

}  // namespace lorica
