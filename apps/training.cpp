#include "apps/training.h"

#include "apps/interrupt.h"
#include "apps/progress_bar.h"
#include "capture/retarget/proxy_skeleton.h"
#include "session/part_bones.h"
#include "session/prepare/keyframes.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace lorica {
namespace {

constexpr double kLikeEnough = 0.02;  // of the character's height: poses that need no keyframe each
constexpr std::size_t kMostKnownFrames = 3000;

/// How far any frame of the training is from the keyframe most like it [m].
double farthestTrained(const TrainingRange& range, const Decomposition& decomposition, const Character& character,
                       const Training& training) {
  std::size_t frameCount = 0;
  for (const SkeletalMotion& motion : training.motions) frameCount += motion.times.size();
  const std::size_t stride = (frameCount + kMostKnownFrames - 1) / kMostKnownFrames;
  double farthest = 0.0;
  for (const SkeletalMotion& motion : training.motions) {
    SkeletalMotion one{motion.name, motion.skeleton, {0.0}, {}};
    for (std::size_t f = 0; f < motion.times.size(); f += stride) {
      const std::span<const JointTransform> pose = motion.pose(static_cast<int>(f));
      one.poses.assign(pose.begin(), pose.end());
      const std::vector<Vec3> posed = poseAllFrames(character, one);
      farthest = std::max(farthest, farthestFrame(range, decomposition, {posed, static_cast<int>(posed.size())}));
    }
  }
  return farthest;
}

}  // namespace

Result<Training> trainingMotions(const Subject& subject, std::span<const std::string> motions) {
  const Character& character = *subject.character;
  Training training;
  const auto add = [&](const Motion& motion) -> Result<void> {
    Result<SkeletalMotion> performed = performedBy(character, motion);
    if (!performed) return performed.error();
    training.motions.push_back(std::move(*performed));
    return {};
  };
  for (const std::string& name : motions) {
    const Result<Motion> motion = readMotion(name);
    if (!motion) return motion.error();
    if (Result<void> added = add(*motion); !added) return added.error();
  }
  if (!training.motions.empty()) return training;
  if (subject.file && !subject.file->clips.empty()) {
    training.ownClips = true;
    training.motions.reserve(subject.file->clips.size());
    for (const Clip& clip : subject.file->clips) {
      training.motions.push_back(framesOf(character.skeleton, clip));
      training.motions.back().name = clip.name;
    }
    return training;
  }
  if (canPerform(character)) {
    const Result<std::vector<Motion>> shipped = readShippedRecordings();
    if (!shipped) return shipped.error();
    for (const Motion& motion : *shipped) {
      if (Result<void> added = add(motion); !added) return added.error();
    }
    return training;
  }
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
    Result<ChosenKeyframes> found =
        chooseKeyframes(character, training.motions, kDefaultKeyframes, kLikeEnough * character.height);
    if (!found) return found.error();
    Keyframes keyframes{std::move(found->positions), static_cast<int>(found->sources.size()), {}, found->farthest};
    keyframes.chosen.reserve(found->sources.size());
    for (const KeyframeSource& source : found->sources) {
      keyframes.chosen.push_back({training.motions[source.motion].name, source.frame, source.time});
    }
    return keyframes;
  }
  if (static_cast<std::size_t>(*count) > frameCount) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("--keyframes: found {}, expected at most {}, the number of frames to choose from", *count,
                             frameCount)};
  }
  Result<std::vector<Vec3>> positions = sampleKeyframes(character, training.motions, *count);
  if (!positions) return positions.error();
  return Keyframes{std::move(*positions), *count, {}, 0.0};
}

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
                              const Training* training, PoseView keyframes, Decomposition decomposition,
                              const Quality& quality) {
  DecompositionFile content;
  content.source = name;
  content.meshHash = topologyHash(mesh);
  content.meanError = quality.error;
  content.errorPerKeyframe = quality.errorPerKeyframe;
  content.ladder = detailLadder(decomposition, mesh, keyframes);
  if (character != nullptr) content.bonesOfPart = bonesOfParts(decomposition, *character);
  if (character != nullptr || keyframes.keyframeCount() > 1) content.training = trainingRange(decomposition, keyframes);
  if (character != nullptr && training != nullptr) {
    content.training->knownDistance = std::max(
        content.training->knownDistance, farthestTrained(*content.training, decomposition, *character, *training));
  }
  content.decomposition = std::move(decomposition);
  return content;
}

}  // namespace lorica
