#include "acd/transfer.h"

#include "geometry/counts.h"

#include <algorithm>

namespace lorica {

void transfer(const Decomposition& decomposition, std::span<const Vec3> posed, std::span<Vec3> points) {
  LORICA_CHECK(countOf(posed) == decomposition.vertexCount, "posed must have one position for each mesh vertex");
  LORICA_CHECK(countOf(points) == decomposition.pointCount(), "points must have room for vertices and cut points");
  if (posed.data() != points.data()) std::copy(posed.begin(), posed.end(), points.begin());
  Vec3* next = points.data() + posed.size();
  for (const CutPoint& c : decomposition.cutPoints) {
    *next++ = c.lambda * points[c.first] + (1.0 - c.lambda) * points[c.second];
  }
}

std::vector<PointIndex> spanningPoints(const Decomposition& decomposition, const Part& part) {
  // A point is `held` if it is in the hull of the part's points in every pose.
  std::vector<bool> held(decomposition.pointCount());
  for (const PointIndex p : part.points) held[p] = true;
  std::vector<PointIndex> spanning;
  spanning.reserve(part.points.size());
  for (const PointIndex p : part.points) {
    if (p < decomposition.vertexCount) spanning.push_back(p);
  }
  PointIndex point = decomposition.vertexCount;
  for (const CutPoint& cut : decomposition.cutPoints) {
    const bool blend = held[cut.first] && held[cut.second];
    const std::size_t own = point;
    if (held[own] && !blend) spanning.push_back(point);
    held[own] = held[own] || blend;
    ++point;
  }
  return spanning;
}

ConvexHull partHull(const Part& part, std::span<const Vec3> points) {
  std::vector<Vec3> own;
  own.reserve(part.points.size());
  for (PointIndex p : part.points) own.push_back(points[p]);
  return convexHull(own);
}

std::vector<ConvexHull> partHulls(const Decomposition& decomposition, std::span<const Vec3> points) {
  std::vector<ConvexHull> hulls;
  hulls.reserve(decomposition.parts.size());
  for (const Part& part : decomposition.parts) hulls.push_back(partHull(part, points));
  return hulls;
}

PoseError errorInPose(const Decomposition& decomposition, const TriMesh& mesh, std::span<const Vec3> posed) {
  std::vector<Vec3> points(decomposition.pointCount());
  transfer(decomposition, posed, points);
  PoseError error;
  error.meshVolume = signedVolume(posed, mesh.triangles);
  std::vector<Vec3> own;
  for (const Part& part : decomposition.parts) {
    own.clear();
    for (PointIndex p : part.points) own.push_back(points[p]);
    error.hullVolume += convexHullVolume(own);
  }
  return error;
}

}  // namespace lorica
