#pragma once

#include "geometry/tri_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

/// Slow and simple checks of a surface, independent of the project's own.
namespace lorica::test {

using DirectedEdges = std::map<std::pair<VertexIndex, VertexIndex>, int>;

inline DirectedEdges directedEdges(const TriMesh& mesh) {
  DirectedEdges edges;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  return edges;
}

/// Volume as a sum of signed tetrahedra about a point near the middle.
inline double volumeOf(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  const Vec3 o(0.0, 1.0, 0.0);
  double sum = 0.0;
  for (const Triangle& t : triangles) {
    const Vec3 a = vertices[t[0]] - o;
    const Vec3 b = vertices[t[1]] - o;
    const Vec3 c = vertices[t[2]] - o;
    sum += a.dot(b.cross(c)) / 6.0;
  }
  return sum;
}

/// How many times the surface winds around a point: 1 inside, 0 outside (solid angles after van Oosterom and Strackee).
inline double windingNumber(const TriMesh& mesh, const Vec3& p) {
  double angle = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - p;
    const Vec3 b = mesh.vertices[t[1]] - p;
    const Vec3 c = mesh.vertices[t[2]] - p;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4.0 * std::numbers::pi);
}

/// Whether the open segment from p to q pierces the triangle.
inline bool pierces(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double dp = normal.dot(p - a);
  const double dq = normal.dot(q - a);
  if ((dp > 0.0) == (dq > 0.0)) return false;
  const Vec3 x = p + dp / (dp - dq) * (q - p);
  return (b - a).cross(x - a).dot(normal) > 0.0 && (c - b).cross(x - b).dot(normal) > 0.0 &&
         (a - c).cross(x - c).dot(normal) > 0.0;
}

/// Edges that pierce a triangle which they do not touch. Two triangles that cross always have such an edge.
inline std::vector<std::pair<VertexIndex, VertexIndex>> piercingEdges(const TriMesh& mesh) {
  constexpr double kCell = 0.02;
  const auto cellOf = [](double x) { return static_cast<std::int64_t>(std::floor(x / kCell)) + 1000; };
  const auto at = [&](VertexIndex v) -> const Vec3& { return mesh.vertices[v]; };
  const auto forCells = [&](std::initializer_list<VertexIndex> corners, const auto& visit) {
    Aabb box;
    for (const VertexIndex v : corners) box.extend(at(v));
    for (std::int64_t x = cellOf(box.min.x()); x <= cellOf(box.max.x()); ++x) {
      for (std::int64_t y = cellOf(box.min.y()); y <= cellOf(box.max.y()); ++y) {
        for (std::int64_t z = cellOf(box.min.z()); z <= cellOf(box.max.z()); ++z) visit((x * 10000 + y) * 10000 + z);
      }
    }
  };

  std::unordered_map<std::int64_t, std::vector<std::size_t>> trianglesOfCell;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& tri = mesh.triangles[t];
    forCells({tri[0], tri[1], tri[2]}, [&](std::int64_t cell) { trianglesOfCell[cell].push_back(t); });
  }
  std::set<std::pair<VertexIndex, VertexIndex>> found;
  for (const auto& [edge, count] : directedEdges(mesh)) {
    const auto [p, q] = edge;
    if (p > q) continue;
    const std::pair<VertexIndex, VertexIndex> undirected(p, q);
    forCells({p, q}, [&](std::int64_t cell) {
      for (const std::size_t t : trianglesOfCell[cell]) {
        const Triangle& tri = mesh.triangles[t];
        const bool touches = std::any_of(
            tri.begin(), tri.end(), [&](VertexIndex v) { return v == undirected.first || v == undirected.second; });
        if (touches) continue;
        if (pierces(at(undirected.first), at(undirected.second), at(tri[0]), at(tri[1]), at(tri[2]))) {
          found.insert(undirected);
        }
      }
    });
  }
  return {found.begin(), found.end()};
}

inline double smallestAngle(const TriMesh& mesh, const Triangle& t) {
  double smallest = std::numbers::pi;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& p = mesh.vertices[t[i]];
    const Vec3 a = mesh.vertices[t[(i + 1) % 3]] - p;
    const Vec3 b = mesh.vertices[t[(i + 2) % 3]] - p;
    smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)));
  }
  return smallest;
}

}  // namespace lorica::test
