#include "session/pose_source.h"

#include "capture/files/joint_csv.h"
#include "capture/retarget/proxy_skeleton.h"
#include "capture/retarget/retarget.h"
#include "capture/standing_legs.h"
#include "geometry/errors.h"
#include "geometry/interrupt.h"
#include "session/joint_trust.h"
#include "session/stream_pose_source.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace lorica {
namespace {

class JointPoseSource final : public PoseSource {
 public:
  JointPoseSource(const Skeleton& skeleton, Retargeter retargeter, std::unique_ptr<SkeletonSource> joints,
                  const JointSettings& settings)
      : retargeter_(std::move(retargeter)),
        joints_(std::move(joints)),
        trust_(skeleton),
        legs_(settings.upperBody ? StandingLegs::Use::kAlways : StandingLegs::Use::kIfUnknown),
        mirror_(settings.mirror) {
    if (settings.smoothing) filter_.emplace(*settings.smoothing);
  }

  Result<std::optional<double>> next(std::span<JointTransform> pose) override {
    const auto begin = std::chrono::steady_clock::now();
    Result<std::optional<SkeletonFrame>> frame = joints_->next();
    waited_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (!frame) return frame.error();
    if (!frame->has_value()) return std::optional<double>();
    present_ = (*frame)->user != kNobody;
    if (mirror_) mirror(**frame);
    judge_.apply(**frame);
    trust_.take(**frame);
    if (filter_) filter_->apply(**frame);
    legs_.apply(**frame);
    retargeter_.apply(**frame, pose);
    return std::optional<double>((*frame)->time);
  }

  [[nodiscard]] std::optional<double> smoothingDelay() const override {
    if (!filter_) return std::nullopt;
    return filter_->delay();
  }
  [[nodiscard]] std::span<const double> trust() const override { return trust_.joints(); }
  [[nodiscard]] double waited() const override { return waited_; }
  [[nodiscard]] bool present() const override { return present_; }
  [[nodiscard]] bool refusedLegs() const override { return judge_.everImplausible(); }

 private:
  Retargeter retargeter_;
  std::unique_ptr<SkeletonSource> joints_;
  LegJudge judge_;
  JointTrust trust_;
  StandingLegs legs_;
  std::optional<OneEuroFilter> filter_;
  bool mirror_;
  bool present_ = true;
  double waited_ = 0.0;
};

class MotionPoseSource final : public PoseSource {
 public:
  explicit MotionPoseSource(SkeletalMotion motion) : motion_(std::move(motion)) {}

  Result<std::optional<double>> next(std::span<JointTransform> pose) override {
    if (frame_ == motion_.frameCount()) return std::optional<double>();
    const std::span<const JointTransform> next = motion_.pose(frame_);
    LORICA_CHECK(next.size() == pose.size(), "the motion must be of the character's own skeleton");
    std::copy(next.begin(), next.end(), pose.begin());
    return std::optional<double>(motion_.times[frame_++]);
  }

 private:
  SkeletalMotion motion_;
  int frame_ = 0;
};

std::unique_ptr<SkeletonSource> recordedSource(std::span<const SkeletonFrame> recording) {
  return makeRecordedSource({recording.begin(), recording.end()});
}

/// Collects all poses of a source into a motion.
Result<SkeletalMotion> playedBy(const Skeleton& skeleton, Result<std::unique_ptr<PoseSource>> source,
                                std::size_t frameCount) {
  if (!source) return source.error();
  SkeletalMotion motion{"", skeleton, {}, {}};
  motion.times.reserve(frameCount);
  motion.poses.reserve(frameCount * skeleton.jointCount());
  Pose pose = restPose(skeleton);
  while (true) {
    if (workStopped()) return cancelled();
    LORICA_TRY(const std::optional<double> time, (*source)->next(pose));
    if (!time.has_value()) return motion;
    motion.times.push_back(*time);
    motion.poses.insert(motion.poses.end(), pose.begin(), pose.end());
  }
}

}  // namespace

Result<std::unique_ptr<PoseSource>> makeJointPoseSource(const Skeleton& skeleton,
                                                        std::unique_ptr<SkeletonSource> joints,
                                                        const JointSettings& settings) {
  LORICA_CHECK(joints != nullptr, "a joint pose source needs a source of joints");
  LORICA_TRY(Retargeter retargeter, Retargeter::create(skeleton));
  return std::unique_ptr<PoseSource>(
      std::make_unique<JointPoseSource>(skeleton, std::move(retargeter), std::move(joints), settings));
}

Result<std::unique_ptr<PoseSource>> makeJointPoseSource(const Character& character,
                                                        std::unique_ptr<SkeletonSource> joints,
                                                        const JointSettings& settings) {
  LORICA_TRY(ProxySkeleton proxy, ProxySkeleton::create(character));
  Result<std::unique_ptr<PoseSource>> source = makeJointPoseSource(proxy.skeleton(), std::move(joints), settings);
  if (!source || proxy.isOwn()) return source;
  return makeProxyPoseSource(std::move(proxy), std::move(*source));
}

std::unique_ptr<PoseSource> makeMotionPoseSource(SkeletalMotion motion) {
  return std::make_unique<MotionPoseSource>(std::move(motion));
}

Result<SkeletalMotion> perform(const Skeleton& skeleton, std::span<const SkeletonFrame> recording,
                               const JointSettings& settings) {
  return playedBy(skeleton, makeJointPoseSource(skeleton, recordedSource(recording), settings), recording.size());
}

Result<SkeletalMotion> perform(const Character& character, std::span<const SkeletonFrame> recording,
                               const JointSettings& settings) {
  return playedBy(character.skeleton, makeJointPoseSource(character, recordedSource(recording), settings),
                  recording.size());
}

}  // namespace lorica
