#pragma once

#include "collision/live/point_row.h"
#include "geometry/tri_mesh.h"

#include <span>
#include <vector>

namespace lorica {

/// A first small hull of some of the points with the origin strictly inside, if one exists; usually it has 4 to 12
/// faces. Exact for coordinates as in PointRow.
class HullStart {
 public:
  /// Reserves memory, so that finding does not allocate for this number of points.
  void fit(std::size_t pointCount);

  /// @return the faces, counter-clockwise from outside; none if the origin is not strictly inside the points' hull
  [[nodiscard]] std::span<const Triangle> find(std::span<const PointRow> points);

 private:
  bool spanTetrahedron(std::span<const PointRow> points);
  void add(std::span<const PointRow> points, VertexIndex p);

  std::vector<Triangle> faces_;
  std::vector<Triangle> kept_;     ///< scratch: faces that a new point does not see
  std::vector<Triangle> visible_;  ///< scratch: faces that it sees
};

}  // namespace lorica
