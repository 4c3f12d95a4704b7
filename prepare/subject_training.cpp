#include "prepare/subject_training.h"

#include "geometry/errors.h"
#include "geometry/text.h"

#include <chrono>
#include <utility>

namespace lorica {

Result<std::vector<Motion>> readMotions(std::span<const std::string> names, Host& host) {
  std::vector<Motion> motions;
  motions.reserve(names.size());
  for (const std::string& name : names) {
    LORICA_TRY(Motion motion, readMotion(name, {}, host));
    motions.push_back(std::move(motion));
  }
  return motions;
}

Result<Training> trainingMotions(const Subject& subject, std::span<const Motion> motions, Host& host) {
  const auto usual = [&]() -> Result<std::vector<Motion>> {
    Result<std::vector<Motion>> shipped = readShippedRecordings();
    if (shipped) return shipped;
    host.warn(shipped.error().message + "; the hulls are trained on the same motions, generated again");
    return makeShippedMotions();
  };
  return trainingMotions(*subject.character, motions, subject.clips(), usual);
}

Result<TimedDecomposition> decomposeWithProgress(const std::string& name, const TriMesh& mesh, PoseView keyframes,
                                                 DecomposeSettings settings, Host& host) {
  Task task(host, "Decomposing " + name, "parts");
  settings.progress = task.progress();
  const auto start = std::chrono::steady_clock::now();
  Result<Decomposition> made = decompose(mesh, keyframes, settings);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!made) {
    // The mesh was rejected: the error names the element, but only this function knows the file.
    if (made.error().code == ErrorCode::kBadMesh) return badMesh(name + ": " + made.error().message);
    return made.error();
  }
  // The last cut may have finished before the progress callback was called.
  if (host.cancelled()) return cancelled();
  return TimedDecomposition{std::move(*made), seconds};
}

}  // namespace lorica
