#pragma once

#include "acd/decompose.h"
#include "acd/decomposition_file.h"
#include "geometry/convex_hull.h"
#include "session/prepare/subject.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lorica {

struct MeshPartsSettings {
  DecomposeSettings decompose;  ///< its limits hold on the hulls that are given, as those of `lorica decompose`
  int hullVertices = 0;         ///< a hull with more is enclosed in a larger one of at most as many, 0 = no limit
  BodyChoice closed = BodyChoice::kIfNeeded;
  WallChoice walls = WallChoice::kByReach;
  double thickness = 0.0;     ///< of thin walls, 0 = automatic
  double maxConcavity = 0.0;  ///< limit of partConcavity() as a share of concavityUnit(), 0 = no limit
};

/// A mesh in convex hulls that together contain every vertex of its surface. Lengths are in the mesh's unit.
struct MeshParts {
  std::vector<ConvexHull> hulls;
  double meshVolume = 0.0;
  double hullVolume = 0.0;    ///< sum over the hulls
  std::string repaired;       ///< what was done to the mesh before; empty = nothing
  DecompositionFile content;  ///< for writeDecomposition()
};

/// A mesh of positions and indices from outside.
/// @param positions  vertexCount x 3
/// @param corners    triangleCount x 3
/// @return the mesh, or a sentence about the first number that is not finite or index that is out of range
[[nodiscard]] Result<TriMesh> checkedMesh(std::span<const double> positions, std::span<const std::int64_t> corners);

/// Repairs the mesh or builds a closed surface around it, decomposes it, and makes the hulls, as `lorica decompose`
/// does. Threads and progress are those of the settings.
[[nodiscard]] Result<MeshParts> partsOfMesh(TriMesh mesh, const MeshPartsSettings& settings);

/// The same parts as those of a file that was written before.
/// @param mesh      the mesh that the file was made from, as it was then
/// @param settings  only hullVertices, closed and threads are used
[[nodiscard]] Result<MeshParts> partsFromFile(const std::filesystem::path& file, TriMesh mesh,
                                              const MeshPartsSettings& settings);

}  // namespace lorica
