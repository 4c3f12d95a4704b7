#pragma once

#include "geometry/math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// The view that grains are chosen for.
struct GrainView {
  Eigen::Matrix4f clipFromWorld;
  Eigen::Vector4f depthFromWorld;  ///< distance along the view direction [m]
  int columns = 1, rows = 1;       ///< cells of the picture; a grain in front fills its cell
};

/// Bound of visible grains in clip space: their centres may be outside the picture. The cells of a view reach as far.
inline constexpr float kBeside = 1.05f;

/// How grains differ, depending on their index.
struct GrainLook {
  float brightness;  ///< 0.8 to 1.2
  float size;        ///< 0.85 to 1.15
  Vec3f shift;       ///< of its centre, at most 0.4 radii along each axis: a bed that was never stirred shows no rows
};
[[nodiscard]] GrainLook lookOfGrain(std::uint32_t index);

/// Chooses the visible grains of a heap. Nearly all grains are hidden behind others, and drawing a grain on a CPU costs
/// a hundred times as much as testing it. A grain is omitted if another one in its cell is nearer by more than a
/// margin, if it is outside the picture, or if it is not finite.
class GrainList {
 public:
  /// @param margin  [m]; not finite = no grain is omitted because of another
  /// @return their indices, ascending
  const std::vector<std::uint32_t>& choose(std::span<const Vec3f> centers, const GrainView& view, float margin);

  /// The cell of each grain of the last call, row by row from below; -1 = outside the picture.
  [[nodiscard]] std::span<const std::int32_t> cells() const { return cell_; }
  /// The depth of each grain in a cell [m].
  [[nodiscard]] std::span<const float> depths() const { return depth_; }

 private:
  std::vector<float> nearest_;  // smallest depth in each cell
  std::vector<float> depth_;
  std::vector<std::int32_t> cell_;
  std::vector<std::uint32_t> chosen_;
};

}  // namespace lorica
