#include "session/prepare/training_motions.h"

#include "capture/retarget/proxy_skeleton.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <utility>

namespace lorica {

Result<Training> trainingMotions(const Character& character, std::span<const Motion> given,
                                 std::span<const Clip> clips) {
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
  if (canPerform(character)) LORICA_TRY_DO(add(shippedMotions()));
  if (training.motions.empty())
    training.motions.push_back({"rest pose", character.skeleton, {0.0}, restPose(character.skeleton)});
  return training;
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
  return trainingMotions(*subject.character, motions, subject.clips());
}

}  // namespace lorica
