#pragma once

namespace lorica {

/// A point as hulls of moving points take it: whole numbers ("ticks") of at most 2^22 either way, in single precision,
/// which holds them and their differences exactly. Four lanes, so that a point is one aligned load.
struct alignas(16) PointRow {
  float x = 0, y = 0, z = 0;
  float w = 0;  ///< not looked at
};

/// Largest coordinate, either way.
inline constexpr float kMostTicks = 4194304.0F;

}  // namespace lorica
