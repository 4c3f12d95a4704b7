#include "player/live_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace lorica {

namespace {

constexpr const char* kStepOut = "person and furniture are connected: step out of the picture for a second";

}  // namespace

void LiveLog::add(const LiveJoints& joints, double seconds, Host& host) {
  const DepthSight& sight = joints.sight();
  figures_.frames = joints.frameCount();
  figures_.followed = joints.followedCount();
  if (sight.read == DepthRead::kFrame) {
    const std::chrono::duration<double, std::micro> latency = std::chrono::steady_clock::now() - sight.arrived;
    figures_.latency.push_back(latency.count());
    figures_.track.push_back(1e6 * sight.trackSeconds);
    if (sight.followed && !figures_.firstPose) figures_.firstPose = seconds;
    figures_.maxPeople = std::max(figures_.maxPeople, sight.people);
  }
  const bool unplugged = sight.read == DepthRead::kUnplugged;
  if (unplugged && !unplugged_) ++figures_.unplugs;
  const char* news = nullptr;
  if (unplugged != unplugged_) {
    news = unplugged ? "the sensor is unplugged; waiting for it" : "the sensor is back";
  } else if (sight.read == DepthRead::kFrame && sight.followed != wasFollowed_) {
    news = sight.followed ? "a person is tracked" : "no person is visible";
  } else if (sight.roomUncertain && !wasUncertain_) {
    news = kStepOut;
  }
  if (news != nullptr) host.tell(fmt::format("{:6.1f} s  {}", seconds, news));
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

}  // namespace lorica
