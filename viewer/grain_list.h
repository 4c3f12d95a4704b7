#pragma once

#include "geometry/math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// What the vertex shader needs of one grain.
struct GrainVertex {
  Vec3f center;
  Vec3f color;  ///< linear RGB, in a shade of its own
};

/// Where grains are looked at from.
struct GrainView {
  Eigen::Matrix4f clipFromWorld;
  Eigen::Vector4f depthFromWorld;  ///< distance along the view, the same unit as the world's
  int columns = 1, rows = 1;       ///< cells of a picture; a grain in front fills its cell
};

/// Chooses the grains of a heap that a view shows: nearly all lie behind others, and drawing one on a processor costs
/// as much as a hundred times looking at it. Those whose cell holds another that is nearer by more than a margin are
/// left out, and so are those beside the picture or not finite.
class GrainList {
 public:
  /// @param colors  of each, or one for all
  /// @param margin  [m]; not finite = none is behind another
  const std::vector<GrainVertex>& choose(std::span<const Vec3f> centers, std::span<const Vec3f> colors,
                                         const GrainView& view, float margin);

 private:
  std::vector<float> nearest_;      // of each cell
  std::vector<float> depth_;        // of each grain
  std::vector<std::int32_t> cell_;  // of each grain; -1 = not in the picture
  std::vector<GrainVertex> chosen_;
};

}  // namespace lorica
