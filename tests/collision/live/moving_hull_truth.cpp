#include "tests/collision/live/moving_hull_truth.h"

#include "geometry/convex_hull.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica::test {
namespace {

__extension__ using Wide = __int128;
using Ticks = std::array<std::int64_t, 3>;

Ticks ticksOf(const PointRow& r) {
  return {static_cast<std::int64_t>(r.x), static_cast<std::int64_t>(r.y), static_cast<std::int64_t>(r.z)};
}

Ticks minus(const Ticks& a, const Ticks& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Ticks cross(const Ticks& u, const Ticks& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

Wide dot(const Ticks& u, const Ticks& v) {
  return static_cast<Wide>(u[0]) * v[0] + static_cast<Wide>(u[1]) * v[1] + static_cast<Wide>(u[2]) * v[2];
}

std::string wrongFaces(const MovingHull& hull, std::span<const Ticks> points, std::span<const Vec3> positions) {
  const std::span<const Triangle> faces = hull.faces();
  std::vector<std::array<VertexIndex, 2>> edges;
  std::vector<VertexIndex> corners;
  edges.reserve(3 * faces.size());
  corners.reserve(3 * faces.size());
  for (const Triangle& t : faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (t[i] < 0 || t[i] >= static_cast<VertexIndex>(points.size())) return fmt::format("corner {}", t[i]);
      corners.push_back(t[i]);
      edges.push_back({t[i], t[(i + 1) % 3]});
    }
  }
  std::sort(edges.begin(), edges.end());
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return "an edge runs one way twice";
  for (const auto& [a, b] : edges) {
    if (!std::binary_search(edges.begin(), edges.end(), std::array{b, a}))
      return fmt::format("edge {} {} is open", a, b);
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  if (corners.size() + faces.size() != edges.size() / 2 + 2) return "Euler's formula does not hold";
  std::vector<VertexIndex> listed(hull.vertices().begin(), hull.vertices().end());
  std::sort(listed.begin(), listed.end());
  if (listed != corners) return "the vertices differ from those of the faces";
  for (const Triangle& t : faces) {
    const Ticks& a = points[t[0]];
    const Ticks n = cross(minus(points[t[1]], a), minus(points[t[2]], a));
    const Wide offset = dot(n, a);
    if (offset <= 0) return fmt::format("face {} {} {} does not face outwards", t[0], t[1], t[2]);
    // Double precision settles most points: three products of at most 2^71 each have a total rounding error below 2^21.
    const Vec3 normal(static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2]));
    const Vec3 corner(static_cast<double>(a[0]), static_cast<double>(a[1]), static_cast<double>(a[2]));
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (normal.dot(positions[p] - corner) < -0x1p21) continue;
      if (dot(n, points[p]) > offset) return fmt::format("point {} is above face {} {} {}", p, t[0], t[1], t[2]);
    }
  }
  return "";
}

}  // namespace

std::vector<PointRow> aboutTheirMean(std::span<const Vec3> points, double ticksPerUnit) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  std::vector<PointRow> rows;
  rows.reserve(points.size());
  for (const Vec3& p : points) {
    const Vec3f q = ((p - mean) * ticksPerUnit).array().round().matrix().cast<float>();
    rows.push_back({q.x(), q.y(), q.z(), 0.0F});
  }
  return rows;
}

std::string whatIsWrong(const MovingHull& hull, std::span<const PointRow> rows) {
  std::vector<Ticks> points;
  std::vector<Vec3> positions;
  points.reserve(rows.size());
  positions.reserve(rows.size());
  for (const PointRow& r : rows) {
    points.push_back(ticksOf(r));
    positions.emplace_back(r.x, r.y, r.z);
  }
  const ConvexHull reference = convexHull(positions);
  if (hull.flat()) {
    if (!hull.vertices().empty() || hull.volume() != 0.0) return "flat, but with vertices or a volume";
    // The reference may lack points that protrude by almost nothing: if it contains the origin, so does the hull of all
    // points.
    const bool inside = std::all_of(reference.triangles.begin(), reference.triangles.end(), [&](const Triangle& t) {
      const auto at = [&](int i) {
        return points[reference.pointOfVertex[static_cast<std::size_t>(t[static_cast<std::size_t>(i)])]];
      };
      return dot(cross(at(0), at(1)), at(2)) > 0;
    });
    return inside && !reference.degenerate() ? "flat, although the origin is inside" : "";
  }
  std::string wrong = wrongFaces(hull, points, positions);
  if (!wrong.empty()) return wrong;
  // The reference leaves out points that protrude by less than 1e-10 of the diagonal.
  const double diagonal = boundsOf(positions).diagonal();
  if (std::abs(hull.volume() - reference.volume) > 1e-9 * diagonal * diagonal * diagonal + 1e-9 * reference.volume) {
    return fmt::format("volume {}, but convexHull() gives {}", hull.volume(), reference.volume);
  }
  return "";
}

}  // namespace lorica::test
