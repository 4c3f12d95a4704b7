#include "capture/headset/worn_headset.h"

#include "capture/registration/registration_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {

void WornHeadset::setRegistration(const std::optional<Registration>& registration) {
  const std::lock_guard lock(mutex_);
  registration_ = registration;
}

void WornHeadset::add(double time, const Vec3& position, const Quat& orientation) {
  const double norm = orientation.norm();
  if (!std::isfinite(time) || !position.allFinite() || !(norm > 0.5 && norm < 2.0)) return;
  const std::lock_guard lock(mutex_);
  if (!poses_.empty() && time <= poses_.back().time) return;
  if (poses_.size() == kMost) poses_.erase(poses_.begin(), poses_.begin() + kMost / 2);
  poses_.push_back({time, position, orientation.normalized()});
}

void WornHeadset::add(const HeadAndHands& pose) {
  if (!std::isfinite(pose.time) || !pose.head.matrix().allFinite()) return;
  add(pose.time, pose.head.translation(), Quat(pose.head.linear()));
  const std::lock_guard lock(mutex_);
  newest_ = pose;
  for (std::optional<Isometry3>& hand : newest_->hands) {
    if (hand && !hand->matrix().allFinite()) hand.reset();
  }
}

void WornHeadset::restart() {
  const std::lock_guard lock(mutex_);
  poses_.clear();
  newest_.reset();
}

std::optional<Registration> WornHeadset::registration() const {
  const std::lock_guard lock(mutex_);
  return registration_;
}

WornHead WornHeadset::headOf(const Vec3& position, const Quat& orientation) const {
  // A headset looks along its -Z, a head along its +Z.
  const Quat stageFromHead = orientation * Quat(Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitY()));
  const Quat floorFromStage(Eigen::AngleAxisd(-registration_->yaw, Vec3::UnitY()));
  return {registration_->headInFloor(position, orientation), floorFromStage * stageFromHead};
}

std::optional<WornHead> WornHeadset::inImage(double time) const {
  const std::lock_guard lock(mutex_);
  if (!registration_ || poses_.empty() || time - poses_.back().time > kGone) return std::nullopt;
  const registration::HeadsetPath path(poses_);
  const double then = std::min(time - registration_->lag, poses_.back().time);
  if (!path.covers(then, then)) return std::nullopt;
  const Isometry3 pose = path.at(then);
  return headOf(pose.translation(), Quat(pose.linear()));
}

std::optional<WornHead> WornHeadset::latest(double now) const {
  const std::lock_guard lock(mutex_);
  if (!registration_ || poses_.empty() || now - poses_.back().time > kGone) return std::nullopt;
  return headOf(poses_.back().position, poses_.back().orientation);
}

std::optional<HeadAndHands> WornHeadset::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

}  // namespace lorica
