#pragma once

#include "capture/streams/bone_stream.h"
#include "capture/streams/osc.h"
#include "capture/streams/packet_file.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// Collects the messages of one sender of the VMC protocol (https://protocol.vmc.info, version 3.1) to frames.
///
/// A frame is complete when every bone that the sender keeps sending has come again; or when a bone comes again, OK or
/// T comes, or 1/90 s has passed. Bones that are not sent again keep their last rotation. Axes are converted from
/// Unity's to Lorica's. Unknown addresses, bones and surplus arguments are ignored, and so are numbers that are not
/// finite, rotations that are none, and positions beyond 100 m. A sender that says once that it is not tracking, and
/// then sends bones for a second and no further state, is tracking. Time tags and the sender's clock are not used.
/// Allocates nothing but the names of up to 256 expressions.
class VmcReceiver {
 public:
  /// @param seconds  when the packet arrived; does not decrease
  /// @return whether frame() is new
  bool take(std::span<const std::byte> packet, double seconds);
  /// To be called when no packet came for a while. @return whether frame() is new
  bool wait(double seconds);

  [[nodiscard]] const BoneFrame& frame() const { return frame_; }
  /// In the order in which they first came; weights as of the last "apply". Those of frame() are as of its end.
  [[nodiscard]] std::span<const NamedWeight> expressions() const { return expressions_; }
  /// Packets that were no OSC, or that no message of was understood.
  [[nodiscard]] std::int64_t refusedCount() const { return refused_; }
  /// The title of the sender's avatar as it reports it; empty if it does not.
  [[nodiscard]] const std::string& title() const { return title_; }

 private:
  /// What a message did.
  enum class Taken : std::uint8_t { kNothing, kState, kBone };

  Taken takeMessage(const OscMessage& message, double seconds);
  Taken takeBone(OscArguments arguments, double seconds);
  Taken takeRoot(OscArguments arguments);
  Taken takeExpression(OscArguments arguments);
  Taken takeState(OscArguments arguments);
  [[nodiscard]] bool allRefreshed(double seconds) const;
  void complete();

  BoneFrame frame_;
  BonePose pending_;
  bool tracking_ = true;
  double stateAt_ = 0.0;                            ///< when the sender last said whether it is tracking [s]
  std::array<double, kHumanBoneCount> lastSeen_{};  ///< of bones that were sent [s]
  std::array<bool, kHumanBoneCount> fresh_{};       ///< since the last complete frame
  int freshCount_ = 0;
  double firstFresh_ = 0.0;
  double now_ = 0.0;
  bool completed_ = false;
  std::vector<NamedWeight> expressions_;
  std::vector<float> wanted_;  ///< weights before "apply"
  std::int64_t refused_ = 0;
  std::string title_;
};

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
