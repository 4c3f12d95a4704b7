#include "session/prepare/training_motions.h"

#include "capture/retarget/proxy_skeleton.h"
#include "geometry/errors.h"
#include "geometry/work_budgets.h"
#include "skinning/humanoid/joint_limits.h"
#include "skinning/linear_blend.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

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

namespace {

constexpr std::uint64_t kSampledSeed = 20180801;
constexpr std::uint64_t kHeldOutSeed = 20180802;
constexpr double kAtRest = 1e-6;  // sine of half the angle by which a bone's rest axes may differ from the model's

/// Whether human joint limits apply to this skeleton: each human bone and all its ancestors have no rest rotation.
bool hasKnownLimits(const Skeleton& skeleton) {
  for (const Joint& joint : skeleton.joints()) {
    const Joint* above = joint.bone ? &joint : nullptr;
    while (above != nullptr) {
      if (above->rest.rotation.vec().norm() > kAtRest) return false;
      above = above->parent == kNoJoint ? nullptr : &skeleton.joint(above->parent);
    }
  }
  return true;
}

/// Appends the transforms of a pose relative to the bind pose.
void append(const Character& character, std::span<const JointTransform> pose, std::vector<Affine3>& worldFromModel) {
  const std::size_t jointCount = character.skeleton.jointCount();
  worldFromModel.resize(worldFromModel.size() + jointCount);
  const std::span<Affine3> last = std::span(worldFromModel).last(jointCount);
  computeWorldFromJoint(character.skeleton, pose, last);
  computeWorldFromModel(character, last, last);
}

void appendRandom(const Character& character, ProxySkeleton& proxy, int count, std::uint64_t seed,
                  std::vector<Affine3>& worldFromModel) {
  RandomNumbers random(seed);
  Pose pose = restPose(character.skeleton);
  for (int i = 0; i < count; ++i) {
    proxy.mapBack(randomPoseWithinLimits(proxy.skeleton(), random), pose);
    append(character, pose, worldFromModel);
  }
}

}  // namespace

Result<CoverPoses> coverPoses(const Character& character, std::span<const SkeletalMotion> motions, int count) {
  LORICA_CHECK(count >= 2, "at least two poses are needed");
  std::size_t frameCount = 0;
  for (const SkeletalMotion& motion : motions) frameCount += motion.times.size();
  Result<ProxySkeleton> proxy = ProxySkeleton::create(character);
  const bool random = proxy && hasKnownLimits(proxy->skeleton());
  if (frameCount == 0 && !random) {
    return invalidArgument(
        "'{}': there are no motions, and the character is not a humanoid whose bones rest along the model's axes; "
        "expected one of the two as a source of poses",
        character.name);
  }

  CoverPoses poses;
  poses.jointCount = character.skeleton.jointCount();
  poses.randomPoses = !random ? 0 : frameCount == 0 ? count : count / 2;
  const auto each = static_cast<std::size_t>(poses.jointCount) * count;
  poses.sampled.reserve(each);
  poses.heldOut.reserve(each);

  // Frame round(i (frameCount - 1) / (wanted - 1)) for each i: sampled if i is even, held out if it is odd.
  const std::size_t wanted = std::min(2 * static_cast<std::size_t>(count - poses.randomPoses), frameCount);
  const std::size_t steps = std::max<std::size_t>(wanted, 2) - 1;
  const auto frameOf = [&](std::size_t i) { return (2 * i * (frameCount - 1) + steps) / (2 * steps); };
  std::size_t next = 0;
  std::size_t frame = 0;
  for (const SkeletalMotion& motion : motions) {
    for (int f = 0; f < motion.frameCount() && next < wanted; ++f, ++frame) {
      if (frame != frameOf(next)) continue;
      append(character, motion.pose(f), next % 2 == 0 ? poses.sampled : poses.heldOut);
      ++next;
    }
  }

  if (random) {
    appendRandom(character, *proxy, poses.randomPoses, kSampledSeed, poses.sampled);
    appendRandom(character, *proxy, poses.randomPoses, kHeldOutSeed, poses.heldOut);
  }
  return poses;
}

}  // namespace lorica
