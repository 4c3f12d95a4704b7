#include "capture/streams/vmc_follower.h"

namespace lorica {
namespace {

/// A sender that is silent for this time gives way to another one [s].
constexpr double kSilentSeconds = 0.5;

}  // namespace

bool VmcFollower::take(std::span<const std::byte> packet, std::uint64_t sender, double seconds) {
  const bool silent = seconds - lastHeard_ > kSilentSeconds;
  if (!followed_ || (silent && *followed_ != sender)) {
    followed_ = sender;
    refusedBefore_ += receiver_.refusedCount();
    receiver_ = {};
  }
  if (*followed_ != sender) {
    ++others_;
    return receiver_.wait(seconds);
  }
  ++packets_;
  const std::int64_t refused = receiver_.refusedCount();
  const bool isNew = receiver_.take(packet, seconds);
  if (receiver_.refusedCount() == refused) lastHeard_ = seconds;  // noise holds no place
  return isNew;
}

bool RecordedStream::wait(double seconds, BoneFrame& frame) {
  const double until = now_ + seconds;
  const std::span<const RecordedPacket> packets = file_->packets();
  bool isNew = false;
  while (!isNew && next_ < packets.size() && packets[next_].time <= until) {
    const RecordedPacket& packet = packets[next_++];
    now_ = packet.time;
    isNew = follower_.take(file_->payload(packet), packet.sender, now_);
  }
  if (!isNew) {
    now_ = until;
    isNew = follower_.wait(now_);
    ended_ = !isNew && next_ == packets.size();
  }
  if (isNew) frame = follower_.receiver().frame();
  return isNew;
}

}  // namespace lorica
