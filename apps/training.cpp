#include "apps/training.h"

#include "apps/interrupt.h"
#include "apps/progress_bar.h"
#include "session/part_bones.h"

#include <chrono>

namespace lorica {

Result<TimedDecomposition> decomposeWithProgress(const std::string& name, const TriMesh& mesh, PoseView keyframes,
                                                 DecomposeSettings settings) {
  const NothingToCleanUp nothing;  // files are written later
  ProgressBar bar("Decomposing " + name, "parts");
  settings.progress = [&bar](int partsDone, int partsWanted) {
    bar.update(partsDone, partsWanted);
    return !interrupted();
  };
  const auto start = std::chrono::steady_clock::now();
  Result<Decomposition> made = decompose(mesh, keyframes, settings);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!made) {
    // The mesh was refused: the sentence knows the element, only here is the file known.
    if (made.error().code == ErrorCode::kBadMesh) return Error{ErrorCode::kBadMesh, name + ": " + made.error().message};
    return made.error();
  }
  // The last cut may have ended before anybody asked whether to go on.
  if (interrupted()) return Error{ErrorCode::kCancelled, "cancelled"};
  return TimedDecomposition{std::move(*made), seconds};
}

DecompositionFile fileContent(const std::string& name, const TriMesh& mesh, const Character* character,
                              PoseView keyframes, Decomposition decomposition, const Quality& quality) {
  DecompositionFile content;
  content.source = name;
  content.meshHash = topologyHash(mesh);
  content.meanError = quality.error;
  content.errorPerKeyframe = quality.errorPerKeyframe;
  content.ladder = detailLadder(decomposition, mesh, keyframes);
  if (character != nullptr) content.bonesOfPart = bonesOfParts(decomposition, *character);
  if (character != nullptr || keyframes.keyframeCount() > 1) content.training = trainingRange(decomposition, keyframes);
  content.decomposition = std::move(decomposition);
  return content;
}

}  // namespace lorica
