#pragma once

namespace lorica {

/// Input point of moving hulls: whole numbers ("ticks") of at most 2^22 in absolute value. Single precision holds them
/// and their differences exactly. Four lanes, so that a point is one aligned load.
struct alignas(16) PointRow {
  float x = 0, y = 0, z = 0;
  float w = 0;  ///< ignored
};

/// Largest absolute coordinate.
inline constexpr float kMaxTicks = 4194304.0F;

}  // namespace lorica
