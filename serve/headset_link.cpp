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

void HeadsetLink::begin(const std::string& camera) {
  if (solving_.valid()) solving_.wait();
  *this = HeadsetLink();
  camera_ = camera;
  if (camera.empty()) return;
  file_ = registrationFile(camera);
  if (const Result<Registration> kept = loadRegistration(file_); kept) known_ = *kept;
}

void HeadsetLink::addHeadset(const Wish& wish, double now) {
  if (camera_.empty()) return;
  if (wish.client != client_ && now - heard_ < kGone) return;
  // Its path begins anew: headsets count from wherever they were put on.
  if (wish.client != client_) {
    samples_.restart();
    clockDifference_ = now - wish.to;
    client_ = wish.client;
    said_.clear();
  }
  heard_ = now;
  clockDifference_ = std::min(clockDifference_, now - wish.to);
  samples_.addHeadset(wish.to + clockDifference_, wish.origin, wish.orientation);
}

void HeadsetLink::addTracked(const Vec3& head, double now) {
  if (now - heard_ < kGone) samples_.addTracked(now, head);
}

/// A registration in words for the page.
std::string HeadsetLink::told(const std::string& advice) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  nlohmann::ordered_json json = {{"type", "registration"}, {"known", known_.has_value()}, {"advice", advice}};
  if (known_) {
    const Isometry3 worldFromStage = known_->stageFromFloor().inverse();
    const Vec3 t = worldFromStage.translation();
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

std::string HeadsetLink::update(double now) {
  if (solving_.valid()) {
    if (solving_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return "";
    const Found found = solving_.get();
    if (found.moved) {
      known_.reset();
      samples_.restart();
    }
    if (found.registration) known_ = found.registration;
    if (found.registration && !file_.empty()) (void)saveRegistration(file_, *known_);  // else it is found again
    return told(found.advice);
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
