#include "capture/smoothing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lorica {
namespace {

/// Cutoff for the speed estimate that controls the main cutoff [Hz]: the authors' choice.
constexpr double kSpeedCutoff = 1.0;
/// Converts angular to linear speed: a rotation of 1 rad/s counts as this speed [m].
constexpr double kLimbLength = 0.3;

/// Weight of the new value in an exponential mean with this cutoff [Hz] after a time step [s].
double shareOf(double cutoff, double step) {
  const double timeConstant = 1.0 / (2.0 * std::numbers::pi * std::max(cutoff, 1e-6));
  return step / (step + timeConstant);
}

/// The rotation as a vector along its axis, the shorter way round [rad].
Vec3 rotationVector(const Quat& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const double length = q.vec().norm();
  if (length < 1e-12) return Vec3::Zero();
  return q.vec() * (sign * 2.0 * std::atan2(length, sign * q.w()) / length);
}

}  // namespace

OneEuroFilter::OneEuroFilter(const OneEuroSettings& settings) : settings_(settings), past_(kPast) {}

void OneEuroFilter::apply(SkeletonFrame& frame) {
  const double step = first_ ? 0.0 : frame.time - lastTime_;
  const bool later = first_ || step > 0.0;  // also false for NaN
  if (later && std::isfinite(frame.time)) lastTime_ = frame.time;
  const SkeletonFrame measured = frame;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) smooth(joints_[j], frame.joints[j], later ? step : 0.0, lastTime_);
  if (later && std::isfinite(frame.time)) {
    first_ = false;
    remember(measured);
    compare(measured, frame);
  }
}

void OneEuroFilter::smooth(Joint& joint, TrackedJoint& tracked, double step, double time) const {
  if (!(tracked.confidence > 0.0) || !tracked.position.allFinite()) {
    joint.seen = joint.turned = false;
    return;
  }
  const double speedShare = shareOf(kSpeedCutoff, step);
  if (!joint.seen) {
    joint.seen = true;
    joint.seenSince = time;
    joint.measured = joint.smoothed = tracked.position;
    joint.velocity = Vec3::Zero();
  } else if (step > 0.0) {
    joint.velocity += speedShare * ((tracked.position - joint.measured) / step - joint.velocity);
    joint.measured = tracked.position;
    const double cutoff = settings_.minCutoff + settings_.beta * joint.velocity.norm();
    joint.smoothed += shareOf(cutoff, step) * (tracked.position - joint.smoothed);
  }
  tracked.position = joint.smoothed;

  if (!tracked.orientation || !(std::abs(tracked.orientation->norm() - 1.0) < 0.5)) {
    joint.turned = false;
    return;
  }
  const Quat turn = tracked.orientation->normalized();
  if (!joint.turned) {
    joint.turned = true;
    joint.measuredTurn = joint.smoothedTurn = turn;
    joint.turnVelocity = Vec3::Zero();
  } else if (step > 0.0) {
    const Vec3 velocity = rotationVector(turn * joint.measuredTurn.conjugate()) / step;
    joint.turnVelocity += speedShare * (velocity - joint.turnVelocity);
    joint.measuredTurn = turn;
    const double cutoff = settings_.minCutoff + settings_.beta * kLimbLength * joint.turnVelocity.norm();
    joint.smoothedTurn = joint.smoothedTurn.slerp(shareOf(cutoff, step), turn).normalized();
  }
  tracked.orientation = joint.smoothedTurn;
}

const OneEuroFilter::Past& OneEuroFilter::past(std::size_t framesAgo) const {
  return past_[(pastCount_ - 1 - framesAgo) % kPast];
}

void OneEuroFilter::remember(const SkeletonFrame& measured) {
  if (pastCount_ > 0 && measured.time - past(0).time < kPastStep) return;
  Past& entry = past_[pastCount_ % kPast];
  entry.time = measured.time;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) entry.measured[j] = measured.joints[j].position;
  ++pastCount_;
}

void OneEuroFilter::compare(const SkeletonFrame& measured, const SkeletonFrame& smoothed) {
  const double time = measured.time;
  constexpr double kLongestLag = kLagStep * (kLags - 1);
  std::array<bool, kBodyJointCount> counts{};
  bool any = false;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) {
    counts[j] = joints_[j].seen && joints_[j].seenSince <= time - kLongestLag;
    any = any || counts[j];
  }
  if (!any) return;

  // Searches backwards from the newest lag; `older` is the first stored frame that is not after the requested time.
  const std::size_t remembered = std::min(pastCount_, kPast);
  std::size_t older = 0;
  for (std::size_t lag = 0; lag < kLags; ++lag) {
    const double when = time - kLagStep * lag;
    while (older + 1 < remembered && past(older).time > when) ++older;
    const Past& before = past(older);
    const double nextTime = older == 0 ? time : past(older - 1).time;
    const double share =
        nextTime > before.time ? std::clamp((when - before.time) / (nextTime - before.time), 0.0, 1.0) : 0.0;
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      if (!counts[j]) continue;
      const Vec3& next = older == 0 ? measured.joints[j].position : past(older - 1).measured[j];
      const Vec3 then = before.measured[j] + share * (next - before.measured[j]);
      disagreement_[lag] += (smoothed.joints[j].position - then).squaredNorm();
    }
  }
}

double OneEuroFilter::delay() const {
  const auto min =
      static_cast<std::size_t>(std::min_element(disagreement_.begin(), disagreement_.end()) - disagreement_.begin());
  if (min == 0 || min + 1 == kLags) return kLagStep * min;
  const double before = disagreement_[min - 1];
  const double after = disagreement_[min + 1];
  const double bend = before - 2.0 * disagreement_[min] + after;
  const double shift = bend > 0.0 ? 0.5 * (before - after) / bend : 0.0;
  return kLagStep * (min + shift);
}

void mirror(SkeletonFrame& frame) {
  for (TrackedJoint& joint : frame.joints) {
    joint.position.x() = -joint.position.x();
    if (!joint.orientation) continue;
    const Quat& q = *joint.orientation;
    joint.orientation = Quat(q.w(), q.x(), -q.y(), -q.z());
  }
  for (const BodyJoint left : kLeftJoints) std::swap(frame[left], frame[rightOf(left)]);
}

}  // namespace lorica
