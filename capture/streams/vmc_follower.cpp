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

}  // namespace lorica
