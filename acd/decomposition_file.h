#pragma once

#include "acd/decomposition.h"
#include "acd/hull_cover.h"
#include "acd/level_of_detail.h"
#include "acd/training_range.h"
#include "geometry/result.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// Share of a part that a bone moves. Bones are names here: this folder knows no skeletons.
struct BoneShare {
  std::string bone;    ///< name of the bone
  double share = 0.0;  ///< above 0, at most 1
};

/// The content of a .lorica file: a decomposition and what is known about it.
struct DecompositionFile {
  Decomposition decomposition;  ///< the parts
  std::string source;           ///< what was decomposed: a file name or "mannequin"
  std::uint64_t meshHash =
      0;  ///< of the mesh's triangles and vertex count: identifies the mesh that the file was made from
  double meanError = 0.0;                                ///< relative volume error, mean over the training keyframes
  std::vector<double> errorPerKeyframe;                  ///< relative volume errors, one for each training keyframe
  std::vector<DetailLevel> detailLevels;                 ///< entry n - 1 is of the first n parts; empty if unknown
  std::vector<std::vector<BoneShare>> bonesOfPart;       ///< for each part, largest share first; empty if unknown
  std::optional<TrainingRange> training = std::nullopt;  ///< the poses that it was made for
  std::optional<HullCover> cover = std::nullopt;         ///< what hulls of its points contain
};

/// Hash of what must agree between a mesh and a decomposition made from it: vertex count and triangles.
[[nodiscard]] std::uint64_t topologyHash(const TriMesh& mesh);

/// Little-endian binary with version and checksum, described in docs/LORICA_FILE.md. Nothing is written on failure.
/// @return success; kInvalidArgument if the content is inconsistent, kUnwritable
[[nodiscard]] Result<void> writeDecomposition(const std::filesystem::path& file, const DecompositionFile& content);

/// The bytes of such a file. @param name  for error messages
[[nodiscard]] Result<std::string> formatDecomposition(const DecompositionFile& content, const std::string& name);

/// @return the content, or a sentence: not a .lorica file, other version, damaged at byte n, wrong checksum
[[nodiscard]] Result<DecompositionFile> readDecomposition(const std::filesystem::path& file);
/// The same for bytes in memory. @param name  for error messages
[[nodiscard]] Result<DecompositionFile> parseDecomposition(std::string_view bytes, const std::string& name);

}  // namespace lorica
