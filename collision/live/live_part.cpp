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

PartVelocity velocityOf(const LivePart& part, double seconds) {
  LORICA_CHECK(seconds > 0.0, "the time between frames must be above 0");
  const Isometry3 &now = part.worldFromPart, &before = part.previousWorldFromPart;
  const Eigen::AngleAxisd turn(Mat3(now.linear() * before.linear().transpose()));
  return {(now.translation() - before.translation()) / seconds, turn.angle() / seconds * turn.axis()};
}

void sweptPoints(const LivePart& part, std::vector<Vec3>& points) {
  const bool changed = part.reshaped && !part.previousVertices.empty();
  points.clear();
  for (const Vec3& v : part.shape.vertices) points.push_back(part.worldFromPart * v);
  for (const Vec3& v : changed ? part.previousVertices : part.shape.vertices) {
    points.push_back(part.previousWorldFromPart * v);
  }
}

ConvexHull sweptHull(const LivePart& part) {
  std::vector<Vec3> points;
  points.reserve(2 * part.shape.vertices.size());
  sweptPoints(part, points);
  return convexHull(points);
}

}  // namespace lorica
