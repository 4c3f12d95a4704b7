#pragma once

#include "acd/decomposition.h"
#include "geometry/result.h"

#include <filesystem>
#include <string>

namespace lorica {

/// What a .lorica file says beside the parts.
struct DecompositionFile {
  Decomposition decomposition;
  std::string source;          ///< what was decomposed: a file name or "mannequin"
  std::uint64_t meshHash = 0;  ///< of the mesh's triangles and vertex count: a file fits one mesh only
  double meanError = 0.0;      ///< relative volume error, mean over the training keyframes
  std::vector<double> errorPerKeyframe;
};

/// Hash of what must agree between a mesh and a decomposition made from it: vertex count and triangles.
[[nodiscard]] std::uint64_t topologyHash(const TriMesh& mesh);

/// Little-endian binary with version and checksum, described in docs/LORICA_FILE.md; written whole or not at all.
[[nodiscard]] Result<void> writeDecomposition(const std::filesystem::path& file, const DecompositionFile& content);

/// @return the content, or a sentence: not a .lorica file, newer version, damaged at byte n, checksum wrong
[[nodiscard]] Result<DecompositionFile> readDecomposition(const std::filesystem::path& file);

}  // namespace lorica
