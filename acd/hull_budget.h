#pragma once

#include "geometry/convex_hull.h"

namespace lorica {

/// A convex hull with a limited number of vertices that encloses another hull.
struct BudgetedHull {
  TriMesh mesh;         ///< convex, counter-clockwise from outside; no triangles for a flat hull
  double volume = 0.0;  ///< [m^3]
  double growth = 1.0;  ///< volume / volume of the enclosed hull, at least 1; 1 for a flat hull
};

/// Encloses a hull in a hull with at most `maxVertices` vertices (engines accept 32, 64 or 255) and little added
/// volume. The input is inside to within 1e-14 of its diagonal. A hull that already has few enough vertices is returned
/// unchanged, as is a hull so thin (1e-9 of its length) that rounding prevents enclosing it.
///
/// Progressive hulls (Sander, Gu, Gortler, Hoppe, Snyder 2000), for convex bodies: repeatedly collapse the cheapest
/// edge to the point outside the body that adds the least volume, until the vertex count is reached; then move the
/// vertices in turn to minimize the volume. The allowed positions of a new point are an intersection of half-spaces,
/// since the plane through the point and an edge of the link must have the whole original body on one side. Affine maps
/// preserve volume ratios, so everything is computed in the body's principal axes, scaled to equal extents: flat and
/// tiny hulls need no special treatment.
///
/// @param maxVertices  at least 4; a flat hull is enclosed in a rectangle
[[nodiscard]] BudgetedHull simplifyHull(const ConvexHull& hull, int maxVertices);

}  // namespace lorica
