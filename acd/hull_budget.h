#pragma once

#include "geometry/convex_hull.h"

namespace lorica {

/// A convex hull with few vertices around another one.
struct BudgetedHull {
  TriMesh mesh;         ///< convex, counter-clockwise from outside; no triangles around a flat hull
  double volume = 0.0;  ///< [m^3]
  double growth = 1.0;  ///< volume / volume of the hull inside, at least 1; 1 for a flat hull
};

/// Encloses a hull in one of at most `maxVertices` vertices (engines take 32, 64 or 255), with little more volume. All
/// of the hull is inside, to within 1e-14 of its diagonal. One that has few enough vertices is left as it is, and so is
/// one so thin (1e-9 of its length) that rounding leaves no way to hold it.
///
/// Progressive hulls (Sander, Gu, Gortler, Hoppe, Snyder 2000), made for convex bodies: an edge shrinks to the point
/// outside the body that adds least volume, always the cheapest edge, until the count is right; then every vertex moves
/// to where the volume is least, in turns. Where the new point may be is an intersection of half-spaces, since a plane
/// through an edge of the link must have the body, the whole original one, on one side. Volume ratios do not change
/// under affine maps: all is done in the body's own axes, scaled to be alike, so flat and tiny hulls are nothing
/// special.
///
/// @param maxVertices  at least 4; a flat hull becomes a rectangle around it
[[nodiscard]] BudgetedHull simplifyHull(const ConvexHull& hull, int maxVertices);

}  // namespace lorica
