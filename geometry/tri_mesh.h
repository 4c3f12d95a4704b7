#pragma once

#include "geometry/math.h"
#include "geometry/result.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

using VertexIndex = std::int32_t;             ///< from 0
using Triangle = std::array<VertexIndex, 3>;  ///< counter-clockwise seen from outside

/// Indexed triangles. Not necessarily closed: see checkClosedTwoManifold().
struct TriMesh {
  std::vector<Vec3> vertices;       ///< [m]
  std::vector<Triangle> triangles;  ///< of indices into `vertices`
};

/// Twice a triangle's area along its normal, by the right-hand rule [m^2].
[[nodiscard]] inline Vec3 areaNormal(std::span<const Vec3> vertices, const Triangle& t) {
  const Vec3& a = vertices[t[0]];
  return (vertices[t[1]] - a).cross(vertices[t[2]] - a);
}

/// Whether two of a triangle's corners are one vertex, so that it has no area.
[[nodiscard]] inline bool hasRepeatedCorner(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// For each of so many vertices, whether a triangle uses it.
[[nodiscard]] std::vector<bool> usedVertices(std::size_t vertexCount, std::span<const Triangle> triangles);

/// Signed volume by the divergence theorem [m^3]; positive if triangles are counter-clockwise from outside.
[[nodiscard]] double signedVolume(std::span<const Vec3> vertices, std::span<const Triangle> triangles);

/// Sum of the triangles' areas [m^2].
[[nodiscard]] double surfaceArea(std::span<const Vec3> vertices, std::span<const Triangle> triangles);

/// Bounds of the vertices that are used by triangles.
[[nodiscard]] Aabb surfaceBounds(const TriMesh& mesh);

/// Number of components connected by shared vertices, and the component of each triangle, numbered in order of first
/// appearance.
struct Components {
  int count = 0;                                  ///< number of connected pieces
  std::vector<std::int32_t> componentOfTriangle;  ///< from 0 to count - 1, one for each triangle
};
/// Pieces whose triangles share vertices.
[[nodiscard]] Components connectedComponents(std::size_t vertexCount, std::span<const Triangle> triangles);

/// Number of edges that belong to exactly one triangle; 0 for a closed mesh. Indices must be in range.
[[nodiscard]] std::size_t openEdgeCount(const TriMesh& mesh);

/// Merges vertices at exactly equal positions into the first of them; vertex order is kept. Triangles that become
/// degenerate are removed. Indices must be in range.
/// @return the number of removed vertices
std::size_t weldEqualVertices(TriMesh& mesh);

/// Checks the requirements of decomposition: indices in range, finite positions, every edge shared by exactly two
/// triangles that run along it in opposite directions, no triangle with a repeated vertex, volume greater than zero
/// (1e-12 of the diagonal's cube) and not inside out. A vertex where two fans of triangles meet is accepted.
/// @return success, or an error that names the first invalid vertex, edge or triangle and the number of them
[[nodiscard]] Result<void> checkClosedTwoManifold(const TriMesh& mesh);

}  // namespace lorica
