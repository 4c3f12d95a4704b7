#include "viewer/player/headset_link.h"

#include "capture/registration/registration_file.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace lorica {
namespace {

constexpr double kBetweenSolves = 2.0;  // [s]
constexpr double kGone = 5.0;           // without a pose of a headset, another one may take its place [s]

}  // namespace

void HeadsetLink::begin(const std::string& camera, std::shared_ptr<WornHeadset> worn) {
  if (solving_.valid()) solving_.wait();
  *this = HeadsetLink();
  if (worn == nullptr) return;
  worn_ = std::move(worn);
  worn_->restart();
  alone_ = camera.empty();
  if (alone_) return;
  file_ = registrationFile(camera);
  const Result<Registration> kept = loadRegistration(file_);
  know(kept ? std::optional(*kept) : std::nullopt);
}

void HeadsetLink::forget() {
  if (worn_ == nullptr || alone_) return;
  if (solving_.valid()) solving_.get();
  know(std::nullopt);
  samples_.clear();
  place_.reset();
}

void HeadsetLink::know(const std::optional<Registration>& registration) {
  known_ = registration;
  worn_->setRegistration(registration);
}

void HeadsetLink::addHeadset(const HeadsetPose& headset, double now) {
  if (worn_ == nullptr) return;
  if (headset.wearer != wearer_ && now - lastPose_ < kGone) return;
  HeadAndHands pose = headset.pose;
  // Its path begins anew: headsets count from wherever they were put on.
  if (headset.wearer != wearer_) {
    samples_.clear();
    place_.reset();
    worn_->restart();
    clockDifference_ = now - pose.time;
    wearer_ = headset.wearer;
    state_.reset();
  }
  lastPose_ = now;
  clockDifference_ = std::min(clockDifference_, now - pose.time);
  pose.time += clockDifference_;
  worn_->add(pose);
  if (alone_) return;
  if (samples_.empty()) samples_.emplace_back();
  for (HeadRegistration& samples : samples_) {
    samples.addHeadset(pose.time, pose.head.translation(), Quat(pose.head.linear()));
  }
}

void HeadsetLink::addTracked(std::size_t place, const Vec3& head, double arrived) {
  if (arrived - lastPose_ >= kGone) return;
  if (samples_.size() <= place) samples_.resize(place + 1);
  samples_[place].addTracked(arrived, head);
}

/// Of several people the one whose head goes as the headset does best. That the camera was moved, the wearer's says.
HeadsetLink::Found HeadsetLink::solve(const std::vector<HeadRegistration>& samples,
                                      const std::optional<Registration>& known, std::optional<std::size_t> place) {
  Found found;
  if (known) {
    found.moved = place ? samples[*place].hasMoved(*known)
                        : std::ranges::all_of(samples, [&](const auto& one) { return one.hasMoved(*known); });
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Result<Registration> solved = samples[i].solve(found.moved ? std::nullopt : known);
    if (!solved && i == 0) found.advice = solved.error().message;
    if (!solved || (found.registration && solved->residual >= found.registration->residual)) continue;
    found.registration = *solved;
    found.place = i;
  }
  if (found.moved) return {{}, {}, true, "the camera or the headset's space was moved: walk about again"};
  if (known) found.advice.clear();
  if (found.registration) found.advice = adviceFor(*found.registration);
  return found;
}

std::optional<WearerState> HeadsetLink::ifChanged(WearerState state) {
  const auto placeIn = [](const WearerState& one) {
    return one.registration ? one.registration->stageFromFloor() : Isometry3::Identity();
  };
  const bool same = state_ && state_->alone == state.alone &&
                    state_->registration.has_value() == state.registration.has_value() &&
                    state_->advice == state.advice && state_->origin == state.origin &&
                    placeIn(*state_).matrix() == placeIn(state).matrix();
  if (same) return std::nullopt;
  return state_ = std::move(state);
}

std::optional<WearerState> HeadsetLink::update(double now, const Vec3& origin) {
  if (alone_) return ifChanged({std::nullopt, "", origin, true});
  if (solving_.valid()) {
    if (solving_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
    const Found found = solving_.get();
    if (found.moved) forget();
    if (found.place) place_ = found.place;
    if (found.registration) know(found.registration);
    if (found.registration && !file_.empty()) (void)saveRegistration(file_, *known_);  // else it is found again
    return ifChanged({known_, found.advice, origin});
  }
  if (now - lastPose_ >= kGone || now - solved_ < kBetweenSolves) return std::nullopt;
  solved_ = now;
  solving_ = std::async(std::launch::async, solve, samples_, known_, place_);
  return std::nullopt;
}

}  // namespace lorica
