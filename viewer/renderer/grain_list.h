#pragma once

#include "geometry/math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Vertex shader input of one grain.
struct GrainVertex {
  Vec3f center;
  Vec3f color;  ///< linear RGB, with a slightly varied brightness
};

/// The view that grains are chosen for.
struct GrainView {
  Eigen::Matrix4f clipFromWorld;
  Eigen::Vector4f depthFromWorld;  ///< distance along the view direction [m]
  int columns = 1, rows = 1;       ///< cells of the picture; a grain in front fills its cell
};

/// Chooses the visible grains of a heap. Nearly all grains are hidden behind others, and drawing a grain on a CPU costs
/// a hundred times as much as testing it. A grain is omitted if another one in its cell is nearer by more than a
/// margin, if it is outside the picture, or if it is not finite.
class GrainList {
 public:
  /// @param colors  one per grain, or one for all
  /// @param margin  [m]; not finite = no grain is omitted because of another
  const std::vector<GrainVertex>& choose(std::span<const Vec3f> centers, std::span<const Vec3f> colors,
                                         const GrainView& view, float margin);

 private:
  std::vector<float> nearest_;      // smallest depth in each cell
  std::vector<float> depth_;        // of each grain
  std::vector<std::int32_t> cell_;  // of each grain; -1 = outside the picture
  std::vector<GrainVertex> chosen_;
};

}  // namespace lorica
