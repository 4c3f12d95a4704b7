#include "session/prepare/training.h"

#include "capture/retarget/proxy_skeleton.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"
#include "session/prepare/keyframes.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace lorica {
namespace {

constexpr double kLikeEnough = 0.02;  // in heights of the character: closer poses need no keyframe of their own

}  // namespace

Result<Training> trainingMotions(const Character& character, std::span<const Motion> given, std::span<const Clip> clips,
                                 const std::function<Result<std::vector<Motion>>()>& usual) {
  Training training;
  const auto add = [&](std::span<const Motion> motions) -> Result<void> {
    for (const Motion& motion : motions) {
      LORICA_TRY(SkeletalMotion performed, performedBy(character, motion));
      training.motions.push_back(std::move(performed));
    }
    return {};
  };
  if (!given.empty()) {
    LORICA_TRY_DO(add(given));
    return training;
  }
  if (!clips.empty()) {
    training.ownClips = true;
    training.motions.reserve(clips.size());
    // Long clips are looked at less often.
    double seconds = 0.0;
    for (const Clip& clip : clips) seconds += clip.seconds;
    const double most = kMaxTrainingPoses / character.skeleton.jointCount() / std::max(seconds, 1.0);
    for (const Clip& clip : clips) {
      const double rate = std::min(clip.framesPerSecond > 0.0 ? clip.framesPerSecond : kClipRate, most);
      training.motions.push_back(sampleWhole(character.skeleton, clip, rate));
      training.motions.back().name = clip.name;
    }
  }
  if (canPerform(character)) {
    const Result<std::vector<Motion>> motions = usual();
    if (!motions && clips.empty()) return motions.error();
    if (motions) {
      LORICA_TRY_DO(add(*motions));
    }
  }
  if (training.motions.empty())
    training.motions.push_back({"rest pose", character.skeleton, {0.0}, restPose(character.skeleton)});
  return training;
}

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

Result<std::vector<Motion>> readMotions(std::span<const std::string> names, Host& host) {
  std::vector<Motion> motions;
  motions.reserve(names.size());
  for (const std::string& name : names) {
    LORICA_TRY(Motion motion, readMotion(name, {}, host));
    motions.push_back(std::move(motion));
  }
  return motions;
}

Result<Training> trainingMotions(const Subject& subject, std::span<const Motion> motions) {
  return trainingMotions(*subject.character, motions, subject.clips(), [] { return Result(shippedMotions()); });
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
