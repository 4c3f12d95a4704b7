#pragma once

#include "skinning/character.h"

#include <span>
#include <vector>

namespace lorica::test {

/// How much longer than in the bind pose the visible edges of a character become: what is left behind shows as long
/// edges between it and the rest.
class EdgeStretch {
 public:
  struct Worst {
    double stretch =
        0.0;            ///< growth of an edge, divided by its length; by 8 % of the height if it is shorter than that
    VertexIndex a = 0;  ///< its ends
    VertexIndex b = 0;
  };

  explicit EdgeStretch(const Character& character);

  /// The edge with the largest stretch.
  /// @param posed  vertexCount positions [m]
  [[nodiscard]] Worst in(std::span<const Vec3> posed) const;

 private:
  struct Edge {
    VertexIndex a, b;
    double length;  ///< in the bind pose [m]
  };
  std::vector<Edge> edges_;
  double height_;
};

/// The largest stretch of a character whose joints all follow: shoulders and hips of coarse meshes come near.
inline constexpr double kMaxStretch = 1.0;

/// The joint with the largest weight at a vertex.
[[nodiscard]] JointIndex mainJoint(const Character& character, VertexIndex vertex);

}  // namespace lorica::test
