#pragma once

#include "acd/decomposition.h"
#include "acd/hull_cover.h"
#include "acd/level_of_detail.h"
#include "acd/training_range.h"
#include "geometry/result.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// What share of a part a bone moves. Names only: this folder knows no skeletons.
struct BoneShare {
  std::string bone;
  double share = 0.0;  ///< above 0, at most 1
};

/// A decomposition and what is known of it, as a .lorica file holds them.
struct DecompositionFile {
  Decomposition decomposition;
  std::string source;          ///< what was decomposed: a file name or "mannequin"
  std::uint64_t meshHash = 0;  ///< of the mesh's triangles and vertex count: a file fits one mesh only
  double meanError = 0.0;      ///< relative volume error, mean over the training keyframes
  std::vector<double> errorPerKeyframe;
  std::vector<DetailLevel> ladder;                       ///< entry n - 1 is of the first n parts; empty where not known
  std::vector<std::vector<BoneShare>> bonesOfPart;       ///< for each part, largest share first; empty where not known
  std::optional<TrainingRange> training = std::nullopt;  ///< what poses it was made for
  std::optional<CoverPromise> cover = std::nullopt;      ///< what a live body made of its points promises
};

/// Hash of what must agree between a mesh and a decomposition made from it: vertex count and triangles.
[[nodiscard]] std::uint64_t topologyHash(const TriMesh& mesh);

/// Little-endian binary with version and checksum, described in docs/LORICA_FILE.md; written whole or not at all. The
/// version is 3, or 4 where the cover holds vertices that no part has.
/// @return success; kInvalidArgument where the content does not hold together, kUnwritable
[[nodiscard]] Result<void> writeDecomposition(const std::filesystem::path& file, const DecompositionFile& content);

/// @return the content, or a sentence: not a .lorica file, newer version, damaged at byte n, checksum wrong
[[nodiscard]] Result<DecompositionFile> readDecomposition(const std::filesystem::path& file);

}  // namespace lorica
