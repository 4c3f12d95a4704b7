#include "capture/confidence_hold.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

/// Limits the step so that a pause in the stream does not turn a blend into a jump.
constexpr double kLongestHoldStep = 0.1;
/// Sums of frame times reach 1 only up to rounding.
constexpr double kWholeTrust = 1.0 - 1e-6;

double smoothStep(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

ConfidenceHold::ConfidenceHold(const Skeleton& skeleton, const ConfidenceHoldSettings& settings)
    : settings_(settings), joints_(skeleton.jointCount()) {
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    JointState& state = joints_[j];
    state.rest = state.shown = state.held = skeleton.joint(j).rest.rotation;
  }
}

void ConfidenceHold::beginFrame(double time) {
  const double passed = frameCount_ == 0 ? 0.0 : time - lastTime_;
  step_ = passed > 0.0 ? std::min(passed, kLongestHoldStep) : 0.0;  // also false for NaN
  if (std::isfinite(time)) lastTime_ = time;
  ++frameCount_;
}

Quat ConfidenceHold::rotation(JointIndex joint, bool known, const Quat& local) {
  JointState& state = joints_[joint];
  if (known) {
    const double distance = state.shown.angularDistance(local);
    const double share = shareTowardsLive(state.trust, distance, settings_.returnTurn);
    state.shown = share >= 1.0 ? local : state.shown.slerp(share, local).normalized();
    return state.shown;
  }
  if (state.trust.lostSeconds == 0.0) state.held = state.shown;
  lose(state.trust);
  if (state.trust.everKnown) {
    const double eased = (state.trust.lostSeconds - settings_.holdSeconds) / std::max(settings_.easeSeconds, 1e-9);
    if (eased > 0.0) state.shown = state.held.slerp(smoothStep(eased), state.rest).normalized();
  }
  return state.shown;
}

Vec3 ConfidenceHold::rootPosition(bool known, const Vec3& position, const Vec3& fallback) {
  if (!known) {
    lose(rootTrust_);
    if (!rootTrust_.everKnown) shownRoot_ = fallback;
    return shownRoot_;
  }
  if (!rootTrust_.everKnown && !inFirstFrame()) shownRoot_ = fallback;
  const double distance = (position - shownRoot_).norm();
  const double share = shareTowardsLive(rootTrust_, distance, settings_.returnSpeed);
  shownRoot_ = share >= 1.0 ? position : Vec3(shownRoot_ + share * (position - shownRoot_));
  return shownRoot_;
}

/// Returns the fraction of the way from the shown to the live value for this frame. These are smooth-step increments,
/// each measured from the current value instead of the start of the blend: a live value that crosses the far side of
/// the sphere then cannot flip the blend direction.
double ConfidenceHold::shareTowardsLive(Trust& trust, double distance, double largestSpeed) const {
  trust.lostSeconds = 0.0;
  if (inFirstFrame() || trust.value >= kWholeTrust) {
    trust.everKnown = true;
    trust.value = 1.0;
    return 1.0;
  }
  trust.everKnown = true;
  const double next = std::min(1.0, trust.value + step_ / std::max(settings_.returnSeconds, 1e-9));
  const double before = smoothStep(trust.value);
  const double share = (smoothStep(next) - before) / (1.0 - before);
  const double largestStep = largestSpeed * step_;
  if (share * distance > largestStep) return largestStep / distance;  // trust waits until the rest fits in one step
  trust.value = next;
  return share;
}

/// A joint that is lost for a single frame keeps most of its trust and hardly lags.
void ConfidenceHold::lose(Trust& trust) const {
  trust.lostSeconds += std::max(step_, 1e-12);
  trust.value = std::max(0.0, trust.value - step_ / std::max(settings_.holdSeconds, 1e-9));
}

}  // namespace lorica
