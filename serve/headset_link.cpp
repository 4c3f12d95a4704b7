#include "serve/headset_link.h"

#include "capture/registration/registration_file.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <numbers>
#include <utility>

namespace lorica {
namespace {

constexpr double kBetweenSolves = 2.0;  // [s]
constexpr double kGone = 5.0;           // without a word from a headset, another one may take its place [s]

}  // namespace

void HeadsetLink::begin(const std::string& camera, std::shared_ptr<WornHeadset> worn) {
  if (solving_.valid()) solving_.wait();
  *this = HeadsetLink();
  if (worn == nullptr) return;
  worn_ = std::move(worn);
  worn_->restart();
  file_ = registrationFile(camera);
  const Result<Registration> kept = loadRegistration(file_);
  know(kept ? std::optional(*kept) : std::nullopt);
}

void HeadsetLink::know(const std::optional<Registration>& registration) {
  known_ = registration;
  worn_->setRegistration(registration);
}

void HeadsetLink::addHeadset(const Wish& wish, double now) {
  if (worn_ == nullptr) return;
  if (wish.client != client_ && now - heard_ < kGone) return;
  // Its path begins anew: headsets count from wherever they were put on.
  if (wish.client != client_) {
    samples_.clear();
    place_.reset();
    worn_->restart();
    clockDifference_ = now - wish.to;
    client_ = wish.client;
    said_.clear();
  }
  heard_ = now;
  clockDifference_ = std::min(clockDifference_, now - wish.to);
  if (samples_.empty()) samples_.emplace_back();
  for (HeadRegistration& samples : samples_) {
    samples.addHeadset(wish.to + clockDifference_, wish.origin, wish.orientation);
  }
  worn_->add(wish.to + clockDifference_, wish.origin, wish.orientation);
}

void HeadsetLink::addTracked(std::size_t place, const Vec3& head, double arrived) {
  if (arrived - heard_ >= kGone) return;
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
    const Result<Registration> solved = known && !found.moved ? samples[i].refine(*known) : samples[i].solve();
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

/// A registration in words for the page.
std::string HeadsetLink::told(const std::string& advice, const Vec3& origin) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  nlohmann::ordered_json json = {{"type", "registration"}, {"known", known_.has_value()}, {"advice", advice}};
  if (known_) {
    const Isometry3 worldFromStage = known_->stageFromFloor().inverse();
    const Vec3 t = worldFromStage.translation() - origin;
    json["yaw"] = -known_->yaw;
    json["translation"] = {t.x(), t.y(), t.z()};
    json["degrees"] = std::round(100.0 * kDegrees * known_->yawDeviation) / 100.0;
    json["millimetres"] = std::round(1e3 * known_->levelDeviation);
  }
  std::string text = json.dump();
  if (text == said_) return "";
  said_ = text;
  return text;
}

std::string HeadsetLink::update(double now, const Vec3& origin) {
  if (solving_.valid()) {
    if (solving_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return "";
    const Found found = solving_.get();
    if (found.moved) {
      know(std::nullopt);
      samples_.clear();
      place_.reset();
    }
    if (found.place) place_ = found.place;
    if (found.registration) know(found.registration);
    if (found.registration && !file_.empty()) (void)saveRegistration(file_, *known_);  // else it is found again
    return told(found.advice, origin);
  }
  if (now - heard_ >= kGone || now - solved_ < kBetweenSolves) return "";
  solved_ = now;
  solving_ = std::async(std::launch::async, solve, samples_, known_, place_);
  return "";
}

}  // namespace lorica
