#include "collision/hulls/training.h"

#include "collision/hulls/keyframes.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace lorica {
namespace {

constexpr double kLikeEnough = 0.02;  // in heights of the character: closer poses need no keyframe of their own

}  // namespace

Result<Keyframes> trainingKeyframes(const Character& character, const Training& training, std::optional<int> count) {
  std::size_t frameCount = 0;
  for (const SkeletalMotion& motion : training.motions) frameCount += motion.times.size();
  if (!count) {
    count =
        training.ownClips ? kChooseKeyframes : static_cast<int>(std::min<std::size_t>(kDefaultKeyframes, frameCount));
  }
  if (*count == kChooseKeyframes) {
    LORICA_TRY(ChosenKeyframes found,
               chooseKeyframes(character, training.motions, kDefaultKeyframes, kLikeEnough * character.height));
    Keyframes keyframes{
        std::move(found.positions), countOf(found.sources), {}, found.farthest, std::move(found.worldFromModel)};
    keyframes.chosen.reserve(found.sources.size());
    for (const KeyframeSource& source : found.sources) {
      keyframes.chosen.push_back({training.motions[source.motion].name, source.frame, source.time});
    }
    return keyframes;
  }
  if (static_cast<std::size_t>(*count) > frameCount) {
    return invalidArgument("found {} keyframes, expected at most {}, the number of frames to choose from", *count,
                           frameCount);
  }
  LORICA_TRY(std::vector<Vec3> positions, sampleKeyframes(character, training.motions, *count));
  return Keyframes{std::move(positions), *count, {}, 0.0, sampleBones(character, training.motions, *count)};
}

Keyframes trainingKeyframes(const Character& character, std::span<const Affine3> worldFromModel) {
  ChosenKeyframes found =
      chooseAmongPoses(character, worldFromModel, kDefaultKeyframes, kLikeEnough * character.height);
  return {std::move(found.positions), countOf(found.sources), {}, found.farthest, std::move(found.worldFromModel)};
}

Result<TimedDecomposition> decomposeTimed(const std::string& name, const TriMesh& mesh, PoseView keyframes,
                                          const DecomposeSettings& settings) {
  const auto start = std::chrono::steady_clock::now();
  Result<Decomposition> made = decompose(mesh, keyframes, settings);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (made) return TimedDecomposition{std::move(*made), seconds};
  // The mesh was rejected: the error names the element, but only this function knows the file.
  if (made.error().code == ErrorCode::kBadMesh) return badMesh(name + ": " + made.error().message);
  return made.error();
}

Result<TimedDecomposition> decomposeWithProgress(const std::string& name, const TriMesh& mesh, PoseView keyframes,
                                                 DecomposeSettings settings, Host& host) {
  Task task(host, "Decomposing " + name, "parts");
  settings.progress = task.progress();
  Result<TimedDecomposition> made = decomposeTimed(name, mesh, keyframes, settings);
  // The last cut may have finished before the progress callback was called.
  if (made && host.cancelled()) return cancelled();
  return made;
}

}  // namespace lorica
