#pragma once

#include "acd/decompose.h"
#include "acd/decomposition_file.h"
#include "apps/quality.h"
#include "skinning/character.h"

#include <string>

namespace lorica {

/// A decomposition and how long it took.
struct TimedDecomposition {
  Decomposition decomposition;
  double seconds = 0.0;
};

/// decompose() with a progress bar; Ctrl-C cancels it.
/// @param name  what is decomposed, for the bar and for errors: "Bunny.off"
[[nodiscard]] Result<TimedDecomposition> decomposeWithProgress(const std::string& name, const TriMesh& mesh,
                                                               PoseView keyframes, DecomposeSettings settings);

/// What a .lorica file keeps of a new decomposition: also its levels of detail, judged in the keyframes, the range of
/// poses that trained it, and the bones that move the parts of a character. No cover.
/// @param character  null for a mesh
[[nodiscard]] DecompositionFile fileContent(const std::string& name, const TriMesh& mesh, const Character* character,
                                            PoseView keyframes, Decomposition decomposition, const Quality& quality);

}  // namespace lorica
