#pragma once

#include "acd/cut.h"
#include "acd/decomposition.h"
#include "geometry/convex_hull.h"

#include <span>
#include <vector>

namespace lorica {

/// An edge of a part that lies on an edge of the original mesh. Borders of caps are not creases: they are convex in the
/// keyframe of their cut by construction, and slivers of caps would give meaningless angles.
struct Crease {
  PointIndex from = 0, to = 0;       ///< the section of the mesh edge in the part
  std::int32_t left = 0, right = 0;  ///< mesh triangles on its sides; `left` runs from -> to
};
[[nodiscard]] std::vector<Crease> creasesOf(const Part& part);

/// A concave edge in one keyframe, with the data for planes through it.
struct ConcaveEdge {
  Vec3 point;       ///< midpoint of its section in the part [m]
  Vec3 direction;   ///< unit, along the edge of the left triangle
  Vec3 leftNormal;  ///< unit normals of the mesh triangles on its sides
  Vec3 rightNormal;
  double depth = 0.0;  ///< depth below the surface of the part's hull [m]
};

/// Unit normals of the mesh's triangles in one keyframe; zero for triangles without area.
[[nodiscard]] std::vector<Vec3> unitNormals(std::span<const Triangle> triangles, std::span<const Vec3> points);

/// Returns the concave edges deepest inside the hull of their part, deepest first, one for each pair of mesh triangles.
/// @param mesh     triangles of the decomposed mesh
/// @param normals  of these triangles, in the keyframe
/// @param points   all points in the keyframe, mesh vertices first
/// @param spacing  minimum distance between the midpoints of two returned edges [m]
[[nodiscard]] std::vector<ConcaveEdge> deepestConcaveEdges(std::span<const Crease> creases,
                                                           std::span<const Triangle> mesh,
                                                           std::span<const Vec3> normals, std::span<const Vec3> points,
                                                           const ConvexHull& hull, int count, double spacing);

/// Returns `count` planes through a concave edge at equal angles, from the plane of one side to that of the other, so
/// that both halves of the outer dihedral angle are convex (Fig. 2). For one plane, the bisector.
[[nodiscard]] std::vector<Plane> planesThrough(const ConcaveEdge& edge, int count);

/// Returns planes that separate pairs of connected components of a part, halfway between their hulls; none for pairs
/// whose hulls touch.
[[nodiscard]] std::vector<Plane> componentPlanes(const Part& part, std::span<const Vec3> points);

}  // namespace lorica
