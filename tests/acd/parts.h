#pragma once

#include "acd/cut.h"
#include "acd/decomposition.h"

#include <map>
#include <span>
#include <utility>
#include <vector>

namespace lorica::test {

/// The whole mesh as one part, as at the start of a decomposition.
inline Part wholeOf(const TriMesh& mesh) {
  Part whole;
  whole.triangles = mesh.triangles;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) whole.sourceTriangle.push_back(static_cast<std::int32_t>(i));
  whole.points = pointsUsedBy(whole.triangles);
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
  for (const auto& [edge, count] : balance) {
    if (count != 0) return false;
  }
  return true;
}

/// The cap triangles of a part.
inline std::vector<Triangle> capsOf(const Part& part) {
  std::vector<Triangle> caps;
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    if (part.sourceTriangle[i] < 0) caps.push_back(part.triangles[i]);
  }
  return caps;
}

/// Appends the positions of new cut points to those of all other points.
inline void append(std::span<const CutPoint> newPoints, std::vector<Vec3>& points) {
  for (const CutPoint& c : newPoints)
    points.push_back(c.lambda * points[c.first] + (1.0 - c.lambda) * points[c.second]);
}

}  // namespace lorica::test
