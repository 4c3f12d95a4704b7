#pragma once

#include "capture/streams/bone_stream.h"
#include "capture/streams/packet_file.h"
#include "capture/streams/vmc_follower.h"

#include <memory>

namespace lorica {

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
