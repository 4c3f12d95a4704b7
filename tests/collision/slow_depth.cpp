#include "tests/collision/slow_depth.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace lorica::test {

double overlapAlong(std::span<const Vec3> a, std::span<const Vec3> b, const Vec3& direction) {
  double high = -std::numeric_limits<double>::infinity(), low = std::numeric_limits<double>::infinity();
  for (const Vec3& v : a) high = std::max(high, v.dot(direction));
  for (const Vec3& v : b) low = std::min(low, v.dot(direction));
  return high - low;
}

double slowDepth(const ConvexHull& a, const ConvexHull& b) {
  double min = std::numeric_limits<double>::infinity();
  const auto look = [&](const Vec3& direction) {
    const double length = direction.norm();
    if (length > 1e-12) min = std::min(min, overlapAlong(a.vertices, b.vertices, direction / length));
  };
  std::vector<Vec3> edges[2];
  for (int side = 0; side < 2; ++side) {
    const ConvexHull& hull = side == 0 ? a : b;
    for (const Triangle& t : hull.triangles) {
      const Vec3& p = hull.vertices[t[0]];
      const Vec3& q = hull.vertices[t[1]];
      const Vec3& r = hull.vertices[t[2]];
      const Vec3 normal = (q - p).cross(r - p);
      look(side == 0 ? normal : Vec3(-normal));
      if (t[0] < t[1]) edges[side].emplace_back(q - p);
      if (t[1] < t[2]) edges[side].emplace_back(r - q);
      if (t[2] < t[0]) edges[side].emplace_back(p - r);
    }
  }
  for (const Vec3& e : edges[0]) {
    for (const Vec3& f : edges[1]) {
      look(e.cross(f));
      look(f.cross(e));
    }
  }
  return min;
}

}  // namespace lorica::test
