#pragma once

#include "geometry/math.h"
#include "geometry/result.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

using VertexIndex = std::int32_t;
using Triangle = std::array<VertexIndex, 3>;  ///< counter-clockwise seen from outside

/// Indexed triangles. Says nothing about closedness: see checkClosedTwoManifold.
struct TriMesh {
  std::vector<Vec3> vertices;  ///< [m]
  std::vector<Triangle> triangles;
};

/// Signed volume by the divergence theorem [m^3]; positive when triangles are counter-clockwise from outside.
[[nodiscard]] double signedVolume(std::span<const Vec3> vertices, std::span<const Triangle> triangles);

/// Sum of the triangles' areas [m^2].
[[nodiscard]] double surfaceArea(std::span<const Vec3> vertices, std::span<const Triangle> triangles);

/// Bounds of the vertices that triangles use.
[[nodiscard]] Aabb surfaceBounds(const TriMesh& mesh);

/// Number of connected components over shared vertices, and each triangle's component, in order of first appearance.
struct Components {
  int count = 0;
  std::vector<std::int32_t> componentOfTriangle;
};
[[nodiscard]] Components connectedComponents(std::size_t vertexCount, std::span<const Triangle> triangles);

/// Number of edges that belong to exactly one triangle; 0 for a mesh that is closed. Indices must be in range.
[[nodiscard]] std::size_t openEdgeCount(const TriMesh& mesh);

/// Makes one vertex of those at exactly equal positions: the first of them stays, order is kept. Triangles that lose
/// a corner by that are dropped. Indices must be in range.
/// @return how many vertices were removed
std::size_t weldEqualVertices(TriMesh& mesh);

/// Checks what decomposition needs of a mesh: indices in range, finite positions, every edge shared by exactly
/// two triangles that run along it in opposite directions, no triangle with a repeated vertex, volume above zero
/// (1e-12 of the diagonal's cube) and not inside out. A vertex where two fans of triangles meet is accepted.
/// @return success, or a sentence naming the first offending vertex, edge or triangle and how many there are
[[nodiscard]] Result<void> checkClosedTwoManifold(const TriMesh& mesh);

}  // namespace lorica
