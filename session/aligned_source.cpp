#include "session/aligned_source.h"

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

JointTransform between(const JointTransform& a, const JointTransform& b, double share) {
  JointTransform joint;
  joint.translation = a.translation + share * (b.translation - a.translation);
  joint.rotation = a.rotation.slerp(share, b.rotation);
  joint.scale = a.scale + share * (b.scale - a.scale);
  return joint;
}

}  // namespace

AlignedSource::AlignedSource(std::unique_ptr<PoseSource> source, const Skeleton& skeleton)
    : source_(std::move(source)), pose_(restPose(skeleton)), previous_(pose_), next_(pose_) {
  LORICA_CHECK(source_ != nullptr, "an avatar needs a source");
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    if (skeleton.joint(j).parent == kNoJoint) roots_.push_back(j);
  }
}

/// Moves the shown pose to its place.
void AlignedSource::place() {
  if (!worldFromSource_) return;
  for (const JointIndex root : roots_) {
    JointTransform& joint = pose_[root];
    joint.translation = *worldFromSource_ * joint.translation;
    joint.rotation = Quat(worldFromSource_->linear()) * joint.rotation;
  }
}

/// Reads the next frame, unless the source has ended.
Result<void> AlignedSource::read() {
  std::swap(previous_, next_);
  std::copy(previous_.begin(), previous_.end(), next_.begin());
  LORICA_TRY(const std::optional<double> time, source_->next(next_));
  ended_ = !time.has_value();
  if (ended_) return {};
  if (!started_) sessionFromSource_ = joined_.value_or(*time) - *time;
  previousTime_ = nextTime_;
  nextTime_ = *time + sessionFromSource_;
  if (!started_) {
    previous_ = next_;
    previousTime_ = nextTime_;
  }
  started_ = pending_ = true;
  return {};
}

Result<std::optional<double>> AlignedSource::lead() {
  if (!pending_) {
    LORICA_TRY_DO(read());
    if (ended_) return std::optional<double>();
  }
  pending_ = false;
  std::copy(next_.begin(), next_.end(), pose_.begin());
  place();
  return std::optional(nextTime_);
}

Result<void> AlignedSource::follow(double time) {
  if (!started_ && !joined_) joined_ = time;
  while (!ended_ && (!started_ || nextTime_ < time)) {
    const bool advanced = started_;
    const double before = nextTime_;
    LORICA_TRY_DO(read());
    if (advanced && nextTime_ <= before) break;  // a live source has nothing newer
  }
  pending_ = !ended_ && nextTime_ > time;
  if (!started_) return {};
  const double length = nextTime_ - previousTime_;
  if (!pending_ || !(length > 0.0)) {
    std::copy(next_.begin(), next_.end(), pose_.begin());
  } else {
    const double share = std::clamp((time - previousTime_) / length, 0.0, 1.0);
    for (std::size_t j = 0; j < pose_.size(); ++j) pose_[j] = between(previous_[j], next_[j], share);
  }
  place();
  return {};
}

}  // namespace lorica
