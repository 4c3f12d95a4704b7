#include "capture/streams/recorded_stream.h"

namespace lorica {

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
