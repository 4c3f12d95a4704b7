#pragma once

#include "acd/cut.h"
#include "acd/decompose.h"
#include "acd/transfer.h"
#include "geometry/counts.h"
#include "tests/acd/hard_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace lorica::test {

/// The mesh's own pose as the only keyframe.
inline PoseView poseOf(const TriMesh& mesh) {
  return {mesh.vertices, countOf(mesh.vertices)};
}

inline Decomposition decomposed(const TriMesh& mesh, const PoseView& keyframes, const DecomposeSettings& settings) {
  Result<Decomposition> made = decompose(mesh, keyframes, settings);
  EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().message);
  return std::move(made).value();
}
inline Decomposition decomposed(const TriMesh& mesh, const DecomposeSettings& settings) {
  return decomposed(mesh, poseOf(mesh), settings);
}

/// The positions of all points in a pose.
inline std::vector<Vec3> transferred(const Decomposition& decomposition, std::span<const Vec3> posed) {
  std::vector<Vec3> points(decomposition.pointCount());
  transfer(decomposition, posed, points);
  return points;
}

/// The whole mesh as one part, as at the start of a decomposition.
inline Part wholeOf(const TriMesh& mesh) {
  Part whole{mesh.triangles, std::vector<std::int32_t>(mesh.triangles.size()), pointsUsedBy(mesh.triangles)};
  std::iota(whole.sourceTriangle.begin(), whole.sourceTriangle.end(), 0);
  return whole;
}

/// Whether triangles run along every edge equally often in both directions.
inline bool isClosed(std::span<const Triangle> triangles) {
  std::map<std::pair<PointIndex, PointIndex>, int> balance;
  for (const Triangle& t : triangles) {
    for (int e = 0; e < 3; ++e) {
      const PointIndex from = t[e], to = t[(e + 1) % 3];
      balance[std::minmax(from, to)] += from < to ? 1 : -1;
    }
  }
  return std::ranges::all_of(balance, [](const auto& edge) { return edge.second == 0; });
}

/// The cap triangles of a part.
inline std::vector<Triangle> capsOf(const Part& part) {
  std::vector<Triangle> caps;
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    if (part.sourceTriangle[i] < 0) caps.push_back(part.triangles[i]);
  }
  return caps;
}

/// The points with these numbers.
inline std::vector<Vec3> chosen(std::span<const PointIndex> ids, std::span<const Vec3> points) {
  std::vector<Vec3> some;
  for (const PointIndex p : ids) some.push_back(points[p]);
  return some;
}

/// Appends the positions of new cut points to those of all other points.
inline void append(std::span<const CutPoint> newPoints, std::vector<Vec3>& points) {
  for (const CutPoint& c : newPoints)
    points.push_back(c.lambda * points[c.first] + (1.0 - c.lambda) * points[c.second]);
}

/// Arbitrary planes through points and, like all candidate planes, some through three of them.
inline std::vector<Plane> planesThrough(std::span<const Vec3> points, Dice& dice, int count) {
  std::vector<Plane> planes;
  while (countOf(planes) < count) {
    const Vec3 a = dice.oneOf(points), b = dice.oneOf(points), c = dice.oneOf(points);
    Vec3 normal = planes.size() % 2 == 0 ? Vec3((b - a).cross(c - a)) : dice.inBox(1.0);
    if (normal.norm() < 1e-3) continue;
    normal.normalize();
    planes.push_back({normal, normal.dot(planes.size() % 4 == 3 ? Vec3(0.5 * (a + b)) : a)});
  }
  return planes;
}

}  // namespace lorica::test
