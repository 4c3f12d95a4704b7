#pragma once

#include "acd/decomposition.h"
#include "acd/hull_budget.h"
#include "geometry/convex_hull.h"
#include "geometry/mesh_files.h"

#include <functional>
#include <span>
#include <vector>

namespace lorica {

/// The parts' hulls as files and engines get them: one object per part, o part_0, o part_1, ...
struct PartHulls {
  std::vector<NamedMesh> objects;
  std::vector<double> growth;         ///< for each part, volume / volume of the hull with all vertices
  double totalGrowth = 1.0;           ///< the same for the sums over the parts
  std::size_t maxVertices = 0;        ///< of a hull
  std::size_t maxVerticesBefore = 0;  ///< of a hull that was not simplified
};

/// The hulls of the parts. @param vertices  of the mesh, in one pose
[[nodiscard]] std::vector<ConvexHull> hullsIn(const Decomposition& decomposition, std::span<const Vec3> vertices);

/// @param hulls        one a part
/// @param budget       hulls beyond it are replaced by larger ones, see simplifyHull()
/// @param progress     if it returns false, the rest is empty
[[nodiscard]] PartHulls simplifyHulls(std::span<const ConvexHull> hulls, const HullBudget& budget, int threads,
                                      const std::function<bool(int done, int hulls)>& progress = {});

/// Checks that vertices are inside a hull, or at most 1e-6 of the hulls' diagonal outside.
/// @param which  indices of the vertices to check
/// @return success, or an error that names the vertex that is farthest outside
[[nodiscard]] Result<void> checkHullsHold(const PartHulls& hulls, std::span<const Vec3> vertices,
                                          std::span<const VertexIndex> which);

}  // namespace lorica
