#pragma once

#include "acd/decompose.h"
#include "acd/decomposition_file.h"
#include "acd/hull_budget.h"
#include "acd/transfer.h"
#include "collision/hulls/frame_hulls.h"
#include "collision/hulls/host.h"
#include "collision/hulls/subject.h"
#include "geometry/arrays/mesh_sequence.h"
#include "geometry/convex_hull.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

struct MeshPartsSettings {
  DecomposeSettings decompose;  ///< its limits hold on the hulls that are given, as those of `lorica decompose`
  int hullVertices = 0;         ///< a hull with more is enclosed in a larger one of at most as many, 0 = no limit
  int hullPlanes = 0;           ///< the same for the planes of its faces
  BodyChoice closed = BodyChoice::kIfNeeded;
  WallChoice walls = WallChoice::kByReach;
  double thickness = 0.0;     ///< of thin walls, 0 = automatic
  int keyframes = 0;          ///< that a mesh in several poses is decomposed in; 0 = up to 12 different ones
  double maxConcavity = 0.0;  ///< limit of partConcavity() as a share of concavityUnit(), 0 = no limit

  [[nodiscard]] HullBudget budget() const { return {hullVertices, hullPlanes}; }
};

/// A mesh in convex hulls that together contain every vertex of its surface. Lengths are in the mesh's unit.
struct MeshParts {
  std::vector<std::vector<ConvexHull>> frames;  ///< of each frame, one a part; a mesh has one frame
  std::vector<PoseError> errors;                ///< of each frame
  std::vector<int> keyframes;                   ///< frames that it was decomposed in
  std::string repaired;                         ///< what was done to the mesh before; empty = nothing
  std::string warning;                          ///< see doubtAboutHulls()
  DecompositionFile content;                    ///< for writeDecomposition()

  [[nodiscard]] const std::vector<ConvexHull>& hulls() const { return frames.front(); }  ///< of the first frame
  /// Mean of all frames: (hull volume - mesh volume) / mesh volume.
  [[nodiscard]] double meanError() const { return meanErrorOf(errors); }
};

/// A mesh of positions and indices from outside, in one or several poses.
/// @param positions    frameCount x vertexCount x 3
/// @param vertexCount  in each frame; 0 if there are no positions
/// @param corners      triangleCount x 3
/// @return the mesh, or a sentence about the first number that is not finite or index that is out of range
[[nodiscard]] Result<MeshSequence> checkedMesh(std::span<const double> positions, std::size_t vertexCount,
                                               std::span<const std::int64_t> corners);

/// Repairs the mesh or builds a closed surface around it, decomposes it, and makes the hulls, as `lorica decompose`
/// does. Threads and progress are those of the settings.
[[nodiscard]] Result<MeshParts> partsOfMesh(MeshSequence mesh, const MeshPartsSettings& settings);

/// Parts that were made before.
struct EarlierParts {
  std::string from;  ///< name of their file, for errors
  DecompositionFile content;
};
[[nodiscard]] Result<EarlierParts> earlierPartsIn(const std::filesystem::path& file);

/// The same parts again.
/// @param mesh      the one that they were made from, as it was then; or another with the same triangles
/// @param settings  only hullVertices, closed and threads are used
[[nodiscard]] Result<MeshParts> partsAsBefore(const EarlierParts& earlier, MeshSequence mesh,
                                              const MeshPartsSettings& settings);

/// partsOfMesh() of a mesh in several poses. @param earlier  parts that were made before; null = to be made
[[nodiscard]] Result<MeshParts> partsOfFrames(MeshSequence mesh, const MeshPartsSettings& settings,
                                              const CharacterOptions& reading, const EarlierParts* earlier, Host& host);

/// What was done to a mesh before, see MeshParts.
[[nodiscard]] std::string repairsOf(const Subject& subject);

}  // namespace lorica
