#include "collision/live/live_part.h"

#include "geometry/result.h"

namespace lorica {

ConvexHull worldHull(const LivePart& part) {
  ConvexHull hull;
  worldHull(part, hull);
  return hull;
}

void worldHull(const LivePart& part, ConvexHull& hull) {
  hull = part.shape;
  for (Vec3& v : hull.vertices) v = part.worldFromPart * v;
}

Vec3 velocityAt(const LivePart& part, const Vec3& point, double seconds) {
  LORICA_CHECK(seconds > 0.0, "the time between frames must be above 0");
  const Vec3 own = part.worldFromPart.inverse() * point;
  return (point - part.previousWorldFromPart * own) / seconds;
}

ConvexHull sweptHull(const LivePart& part) {
  const bool changed = part.reshaped && !part.previousVertices.empty();
  const std::vector<Vec3>& before = changed ? part.previousVertices : part.shape.vertices;
  std::vector<Vec3> points;
  points.reserve(before.size() + part.shape.vertices.size());
  for (const Vec3& v : part.shape.vertices) points.push_back(part.worldFromPart * v);
  for (const Vec3& v : before) points.push_back(part.previousWorldFromPart * v);
  return convexHull(points);
}

}  // namespace lorica
