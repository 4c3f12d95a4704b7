#pragma once

#include "geometry/convex_hull.h"

namespace lorica {

/// A convex hull within a budget that encloses another hull.
struct BudgetedHull {
  TriMesh mesh;         ///< convex, counter-clockwise from outside; no triangles for a flat hull
  double volume = 0.0;  ///< [m^3]
  double growth = 1.0;  ///< volume / volume of the enclosed hull, at least 1; 1 for a flat hull
};

/// What a hull may have at most; 0 = no limit.
struct HullBudget {
  int vertices = 0;        ///< at least 4; what engines limit: 32, 64 or 255
  int planes = 0;          ///< at least 4; a face of four corners or more has one. What clipping and brushes limit
  bool turnPlanes = true;  ///< see fewerPlanes(); false as in its source

  [[nodiscard]] bool given() const { return vertices > 0 || planes > 0; }
  friend bool operator==(const HullBudget&, const HullBudget&) = default;
};

/// Encloses a hull in one within a budget and with little added volume. The input is inside to within 1e-14 of its
/// diagonal. A hull that is within the budget is returned unchanged, as is a hull so thin (1e-9 of its length) that
/// rounding prevents enclosing it. A flat hull is enclosed in a rectangle.
///
/// With a limit of planes see fewerPlanes(). Without: progressive hulls (Sander, Gu, Gortler, Hoppe, Snyder 2000), for
/// convex bodies: repeatedly collapse the cheapest edge to the point outside the body that adds the least volume, until
/// the vertex count is reached; then move the vertices in turn to minimize the volume. The allowed positions of a new
/// point are an intersection of half-spaces, since the plane through the point and an edge of the link must have the
/// whole original body on one side. Affine maps preserve volume ratios, so everything is computed in the body's
/// principal axes, scaled to equal extents: flat and tiny hulls need no special treatment.
[[nodiscard]] BudgetedHull simplifyHull(const ConvexHull& hull, const HullBudget& budget);

}  // namespace lorica
