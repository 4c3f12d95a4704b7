#pragma once

#include "capture/streams/bone_stream.h"
#include "capture/streams/packet_file.h"
#include "capture/streams/vmc_receiver.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace lorica {

/// Follows one of several senders of VMC packets: the first, and another one when that was silent for half a second.
/// Each is received from its beginning.
class VmcFollower {
 public:
  /// @param sender   tells senders apart
  /// @param seconds  when the packet arrived; does not decrease
  /// @return whether receiver().frame() is new
  bool take(std::span<const std::byte> packet, std::uint64_t sender, double seconds);
  /// To be called when no packet came for a while. @return whether receiver().frame() is new
  bool wait(double seconds) { return receiver_.wait(seconds); }

  [[nodiscard]] const VmcReceiver& receiver() const { return receiver_; }
  /// Packets of the senders that were followed, and of those that were not.
  [[nodiscard]] std::int64_t packets() const { return packets_; }
  [[nodiscard]] std::int64_t others() const { return others_; }
  /// Packets of the followed senders that were not understood.
  [[nodiscard]] std::int64_t refused() const { return refusedBefore_ + receiver_.refusedCount(); }

 private:
  VmcReceiver receiver_;
  std::optional<std::uint64_t> followed_;
  double lastHeard_ = 0.0;
  std::int64_t packets_ = 0, others_ = 0;
  std::int64_t refusedBefore_ = 0;  ///< of earlier senders
};

/// Plays recorded VMC packets as VmcStream would have received them: one frame after another, at the times at which
/// their packets arrived. The same file gives the same frames each time. It waits for nothing.
class RecordedStream final : public BoneStream {
 public:
  explicit RecordedStream(std::shared_ptr<const PacketFile> file) : file_(std::move(file)) {}

  [[nodiscard]] bool wait(double seconds, BoneFrame& frame) override;
  [[nodiscard]] bool ready() const override { return !ended(); }
  [[nodiscard]] double now() const override { return now_; }
  [[nodiscard]] bool ended() const override { return ended_; }
  [[nodiscard]] const VmcFollower& follower() const { return follower_; }

 private:
  std::shared_ptr<const PacketFile> file_;
  VmcFollower follower_;
  std::size_t next_ = 0;
  double now_ = 0.0;
  bool ended_ = false;
};

}  // namespace lorica
