#pragma once

#include "acd/cut.h"
#include "acd/decomposition.h"
#include "geometry/convex_hull.h"

#include <span>
#include <vector>

namespace lorica {

/// An edge of a part that lies on an edge of the original mesh. Borders of caps are no creases: they are convex in the
/// keyframe of their cut by construction, and slivers of caps would give angles that mean nothing.
struct Crease {
  PointIndex from = 0, to = 0;       ///< the piece of the edge within the part
  std::int32_t left = 0, right = 0;  ///< mesh triangles on its two sides; `left` runs from -> to
};
[[nodiscard]] std::vector<Crease> creasesOf(const Part& part);

/// A concave edge in one keyframe with what is needed to lay planes through it.
struct ConcaveEdge {
  Vec3 point;       ///< the middle of its piece [m]
  Vec3 direction;   ///< unit, along the edge of the left triangle
  Vec3 leftNormal;  ///< unit normals of the mesh triangles on its sides
  Vec3 rightNormal;
  double depth = 0.0;  ///< distance from the part's hull, measured from inside [m]
};

/// Unit normals of the mesh's triangles in one keyframe; zero for those without area.
[[nodiscard]] std::vector<Vec3> unitNormals(std::span<const Triangle> triangles, std::span<const Vec3> points);

/// The concave edges deepest inside the hull of their part, deepest first, one for each pair of mesh triangles.
/// @param mesh     triangles of the decomposed mesh
/// @param normals  of those, in the keyframe
/// @param points   all points in the keyframe, mesh vertices first
/// @param spacing  least distance between the middles of two of them [m]
[[nodiscard]] std::vector<ConcaveEdge> deepestConcaveEdges(std::span<const Crease> creases,
                                                           std::span<const Triangle> mesh,
                                                           std::span<const Vec3> normals, std::span<const Vec3> points,
                                                           const ConvexHull& hull, int count, double spacing);

/// `count` planes through a concave edge at equal angles, from the plane of one side to that of the other, so that both
/// halves of the outer dihedral angle are convex (Fig. 2). One plane: the bisector.
[[nodiscard]] std::vector<Plane> planesThrough(const ConcaveEdge& edge, int count);

/// Planes that separate pairs of connected components of a part, halfway between their hulls; none for pairs whose
/// hulls touch.
[[nodiscard]] std::vector<Plane> componentPlanes(const Part& part, std::span<const Vec3> points);

}  // namespace lorica
