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
    samples_.restart();
    worn_->restart();
    clockDifference_ = now - wish.to;
    client_ = wish.client;
    said_.clear();
  }
  heard_ = now;
  clockDifference_ = std::min(clockDifference_, now - wish.to);
  samples_.addHeadset(wish.to + clockDifference_, wish.origin, wish.orientation);
  worn_->add(wish.to + clockDifference_, wish.origin, wish.orientation);
}

void HeadsetLink::addTracked(const Vec3& head, double arrived) {
  if (arrived - heard_ < kGone) samples_.addTracked(arrived, head);
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
      samples_.restart();
    }
    if (found.registration) know(found.registration);
    if (found.registration && !file_.empty()) (void)saveRegistration(file_, *known_);  // else it is found again
    return told(found.advice, origin);
  }
  if (now - heard_ >= kGone || now - solved_ < kBetweenSolves) return "";
  solved_ = now;
  solving_ = std::async(std::launch::async, [samples = samples_, known = known_] {
    Found found;
    found.moved = known && samples.hasMoved(*known);
    const Result<Registration> solved = known && !found.moved ? samples.refine(*known) : samples.solve();
    if (solved && !found.moved) found.registration = *solved;
    if (found.moved) found.advice = "the camera or the headset's space was moved: walk about again";
    if (!known && !solved) found.advice = solved.error().message;
    if (solved) found.advice = adviceFor(*solved);
    return found;
  });
  return "";
}

}  // namespace lorica
