#pragma once

#include "geometry/tri_mesh.h"

#include <span>
#include <vector>

namespace lorica {

/// A closed convex polyhedron whose vertices are a subset of the caller's points.
struct ConvexHull {
  std::vector<VertexIndex> pointOfVertex;  ///< for each hull vertex, its index in the input points
  std::vector<Vec3> vertices;              ///< [m]
  std::vector<Triangle> triangles;         ///< over `vertices`, counter-clockwise from outside
  double volume = 0.0;                     ///< [m^3]; 0 for coplanar, collinear or coincident points

  /// True if the hull has no volume: fewer than four points, or all coplanar. It then has vertices but no triangles.
  [[nodiscard]] bool degenerate() const { return triangles.empty(); }
};

/// Computes the convex hull of points, in double precision. Every input point lies inside, or outside by at most 1e-9
/// of the set's diagonal. The same points in the same order give the same hull. Never fails: flat input gives a
/// degenerate hull.
[[nodiscard]] ConvexHull convexHull(std::span<const Vec3> points);

/// Computes only the volume of the hull [m^3].
/// @param tolerance  ignores points that lie above a face by up to this fraction of the set's diagonal. A coarse
///                   tolerance is much faster and slightly underestimates the volume.
[[nodiscard]] double convexHullVolume(std::span<const Vec3> points, double tolerance = 1e-10);

/// Vertices and volume of a hull, without its faces.
struct HullOutline {
  std::vector<VertexIndex> points;  ///< indices of the hull vertices, ascending; all points if the set is flat
  double volume = 0.0;              ///< [m^3]
};

/// Computes the hull's vertices and volume.
/// @param tolerance  see convexHullVolume()
[[nodiscard]] HullOutline convexHullOutline(std::span<const Vec3> points, double tolerance = 1e-10);

/// Returns the largest distance by which a point lies outside the hull's planes [m]; 0 if all are inside.
[[nodiscard]] double largestViolation(const ConvexHull& hull, std::span<const Vec3> points);

}  // namespace lorica
