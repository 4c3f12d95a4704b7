#pragma once

#include "geometry/tri_mesh.h"

#include <span>
#include <vector>

namespace lorica {

/// A closed convex polyhedron over points of a set that the caller keeps.
struct ConvexHull {
  std::vector<VertexIndex> pointOfVertex;  ///< for each hull vertex, its index in the input points
  std::vector<Vec3> vertices;              ///< [m]
  std::vector<Triangle> triangles;         ///< over `vertices`, counter-clockwise from outside
  double volume = 0.0;                     ///< [m^3]; 0 for a flat, straight or single-point set

  /// No volume: fewer than four points, or all on a plane. Such a hull has its points but no triangles.
  [[nodiscard]] bool degenerate() const { return triangles.empty(); }
};

/// Convex hull of points, in double precision. Every input point is inside or within 1e-9 of the set's diagonal.
/// Same points in the same order give the same hull. Never fails: flat input gives a degenerate hull.
[[nodiscard]] ConvexHull convexHull(std::span<const Vec3> points);

/// Volume of the hull only [m^3].
/// @param tolerance  points up to this share of the set's diagonal above a face are left out; a coarse tolerance gives
/// a
///                   slightly small volume in a fraction of the time, and always from inside
[[nodiscard]] double convexHullVolume(std::span<const Vec3> points, double tolerance = 1e-10);

/// What a hull is about, without its faces.
struct HullOutline {
  std::vector<VertexIndex> points;  ///< those that span it, ascending; all of them when the set is flat
  double volume = 0.0;              ///< [m^3]
};

/// The points that span the hull to within that tolerance, and its volume.
[[nodiscard]] HullOutline convexHullOutline(std::span<const Vec3> points, double tolerance = 1e-10);

/// Largest distance of any point outside the hull's planes [m]; 0 when all are inside.
[[nodiscard]] double largestViolation(const ConvexHull& hull, std::span<const Vec3> points);

}  // namespace lorica
