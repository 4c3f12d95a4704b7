#include "session/prepare/motion.h"

#include "capture/files/joint_csv.h"
#include "capture/retarget/proxy_skeleton.h"
#include "capture/retarget/skeletal_retarget.h"
#include "capture/streams/vmc_receiver.h"
#include "geometry/errors.h"
#include "geometry/work_budgets.h"
#include "session/stream_pose_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {
namespace {

Error onCharacter(const Motion& motion, const Character& character, const Error& error) {
  return {error.code, fmt::format("{} on {}: {}{}", motion.name, character.name, error.message, mapHint(character))};
}

/// The source of a motion of packets.
Result<std::unique_ptr<PoseSource>> streamSourceOf(const Character& character, const Motion& motion,
                                                   const JointSettings& settings) {
  const std::shared_ptr<const SenderRest>& sender = motion.packets->sender;
  Result<std::unique_ptr<PoseSource>> source =
      makeStreamPoseSource(character, std::make_unique<RecordedStream>(motion.packets->file),
                           {settings.mirror, sender ? std::optional(*sender) : std::nullopt});
  if (!source) return onCharacter(motion, character, source.error());
  return source;
}

}  // namespace

std::string mapHint(const Character& character) {
  if (canPerform(character)) return "";
  return "; if it is a humanoid, write a bone map with `lorica info FILE --write-map MAP.json`, edit it and pass it "
         "with --map";
}

int Motion::framesIn(double some) const {
  const double share = std::min(1.0, some / std::max(seconds(), 1e-6));
  return std::max(1, int(std::ceil(share * (frameCount() - 1) - 1e-4)));
}

Result<SkeletalMotion> framesOf(const Skeleton& skeleton, const Clip& clip) {
  const double rate = clip.framesPerSecond > 0.0 ? clip.framesPerSecond : kClipRate;
  const double longest = kMaxClipPoses / rate / skeleton.jointCount();
  if (clip.seconds > longest) {
    return unsupported("the clip '{}' lasts {:.0f} s, expected at most {:.0f} s with {} joints", clip.name,
                       clip.seconds, longest, skeleton.jointCount());
  }
  return sampleWhole(skeleton, clip, rate);
}

Result<SkeletalMotion> performedBy(const Character& character, const Motion& motion, const JointSettings& settings) {
  const auto named = [&](Result<SkeletalMotion> performed) -> Result<SkeletalMotion> {
    if (!performed) return onCharacter(motion, character, performed.error());
    performed->name = motion.name;
    return performed;
  };
  if (!motion.bones) return named(perform(character, motion.joints, settings));
  if (motion.fromCharacterFile && !settings.mirror) {
    Result<SkeletalMotion> renamed = retargetByJointNames(*motion.bones, character.skeleton);
    if (renamed) return named(std::move(renamed));
  }
  SkeletalRetargetSettings retargeting;
  retargeting.mirror = settings.mirror;
  return named(retargetMotion(*motion.bones, character, retargeting));
}

Result<void> checkPerformed(const Character& character, const Motion& motion, const JointSettings& settings) {
  if (motion.packets) {
    LORICA_TRY_DO(streamSourceOf(character, motion, settings));
    return {};
  }
  Motion first{motion.name, {}, std::nullopt, std::nullopt, std::nullopt, motion.fromCharacterFile, motion.format, {}};
  if (motion.bones) {
    const std::span<const JointTransform> pose = motion.bones->pose(0);
    first.bones = SkeletalMotion{
        motion.bones->name, motion.bones->skeleton, {motion.bones->times.front()}, {pose.begin(), pose.end()}};
  } else {
    first.joints = {motion.joints.front()};
  }
  LORICA_TRY_DO(performedBy(character, first, settings));
  return {};
}

Result<std::unique_ptr<PoseSource>> poseSourceOf(const Character& character, const Motion& motion,
                                                 const SourceTreatment& treatment) {
  if (motion.packets) {
    LORICA_TRY(std::unique_ptr<PoseSource> source, streamSourceOf(character, motion, treatment.joints));
    return makeTreatedSource(std::move(source), treatment);
  }
  if (!motion.bones) {
    Result<std::unique_ptr<PoseSource>> source =
        makeTreatedSource(character, makeRecordedSource(motion.joints), treatment);
    if (!source) return onCharacter(motion, character, source.error());
    return source;
  }
  LORICA_TRY(SkeletalMotion performed, performedBy(character, motion, treatment.joints));
  return makeTreatedSource(makeMotionPoseSource(std::move(performed)), treatment);
}

}  // namespace lorica
