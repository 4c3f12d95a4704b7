#pragma once

#include "geometry/tri_mesh.h"

#include <array>
#include <set>

namespace lorica::test {

using Voxel = std::array<int, 3>;

/// The surface of a union of unit cubes with corners at integer positions, one vertex per corner. If cubes touch only
/// along an edge, four triangles share it: closed, but not a two-manifold.
[[nodiscard]] TriMesh makeVoxelSurface(const std::set<Voxel>& voxels);

/// Axis-aligned box from min to max, 8 vertices, 12 triangles, closed and outward.
[[nodiscard]] TriMesh makeBox(const Vec3& min, const Vec3& max);

/// The corner tetrahedron 0, x, y, z: volume 1/6.
[[nodiscard]] TriMesh makeTetrahedron();

/// An L-shaped prism of unit thickness: three unit squares, volume 3, one concave edge.
[[nodiscard]] TriMesh makeLShape();

/// Torus about Y: closed, genus 1.
[[nodiscard]] TriMesh makeTorus(double majorRadius, double minorRadius, int majorSegments, int minorSegments);

/// Unit-radius UV sphere scaled; closed.
[[nodiscard]] TriMesh makeSphere(double radius, int rings, int segments);

/// A solid box from 0 to 3 with a cavity from 1 to 2 in all directions: volume 26.
[[nodiscard]] TriMesh makeHollowBox();

[[nodiscard]] TriMesh insideOut(TriMesh mesh);
[[nodiscard]] TriMesh shifted(TriMesh mesh, const Vec3& by);

/// The mesh with every vertex mapped.
template <class Map>
[[nodiscard]] TriMesh moved(TriMesh mesh, const Map& map) {
  for (Vec3& v : mesh.vertices) v = map(v);
  return mesh;
}

/// The same surface with each triangle divided in four at the middles of its edges, so many times.
[[nodiscard]] TriMesh divided(TriMesh mesh, int times = 1);

/// Both meshes as one, vertices of b after those of a.
[[nodiscard]] TriMesh joined(const TriMesh& a, const TriMesh& b);

}  // namespace lorica::test
