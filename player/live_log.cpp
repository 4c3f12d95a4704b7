#include "player/live_log.h"

#include "player/percentiles.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>

namespace lorica {

namespace {

constexpr const char* kStepOut = "person and furniture are connected: step out of the picture for a second";

}  // namespace

void LiveLog::add(const LiveJoints& joints, double seconds) {
  const DepthSight& sight = joints.sight();
  frames_ = joints.frameCount();
  followed_ = joints.followedCount();
  if (sight.read == DepthRead::kFrame) {
    const std::chrono::duration<double, std::micro> latency = std::chrono::steady_clock::now() - sight.arrived;
    latency_.push_back(latency.count());
    track_.push_back(1e6 * sight.trackSeconds);
    if (sight.followed && !firstPose_) firstPose_ = seconds;
    maxPeople_ = std::max(maxPeople_, sight.people);
  }
  const bool unplugged = sight.read == DepthRead::kUnplugged;
  if (unplugged && !unplugged_) ++unplugs_;
  const char* news = nullptr;
  if (unplugged != unplugged_) {
    news = unplugged ? "the sensor is unplugged; waiting for it" : "the sensor is back";
  } else if (sight.read == DepthRead::kFrame && sight.followed != wasFollowed_) {
    news = sight.followed ? "a person is tracked" : "no person is visible";
  } else if (sight.roomUncertain && !wasUncertain_) {
    news = kStepOut;
  }
  if (news != nullptr) say(fmt::format("{:6.1f} s  {}\n", seconds, news));
  unplugged_ = unplugged;
  if (sight.read == DepthRead::kFrame) {
    wasFollowed_ = sight.followed;
    wasUncertain_ = sight.roomUncertain;
  }
}

std::string LiveLog::state() const {
  if (unplugged_) return "the sensor is unplugged";
  if (wasUncertain_) return kStepOut;
  return wasFollowed_ ? "" : "no person is visible";
}

void LiveLog::addTo(nlohmann::ordered_json& json) const {
  json["depthFrames"] = frames_;
  json["framesWithPerson"] = followed_;
  json["maxPeople"] = maxPeople_;
  json["unplugged"] = unplugs_;
  json["firstPose"] = firstPose_ ? nlohmann::ordered_json(*firstPose_) : nlohmann::ordered_json();
  const Percentiles track = percentilesOf(track_);
  const Percentiles latency = percentilesOf(latency_);
  json["tracking"] = {{"median", track.median}, {"p95", track.p95}};
  json["latency"] = {{"median", latency.median}, {"p95", latency.p95}};
}

void LiveLog::addTo(Report& report) const {
  if (followed_ == 0) {
    report.line("person", fmt::format("{} in {}", maxPeople_ > 0 ? "requested person not found" : "not found",
                                      counted(frames_, "depth frame")));
  } else {
    report.line("person", fmt::format("tracked in {} of {}, first after {:.2f} s; at most {} at once",
                                      grouped(followed_), counted(frames_, "depth frame"), *firstPose_, maxPeople_));
  }
  if (unplugs_ > 0) report.line("sensor", "unplugged " + counted(unplugs_, "time"));
  if (track_.empty()) return;
  const Percentiles track = percentilesOf(track_);
  const Percentiles latency = percentilesOf(latency_);
  report.line("tracking", fmt::format("{} per frame (95 % below {})", duration(track.median), duration(track.p95)));
  report.line("latency", fmt::format("{} from a depth frame to posed hulls (95 % below {})", duration(latency.median),
                                     duration(latency.p95)));
}

}  // namespace lorica
