#pragma once

#include "capture/streams/bone_stream.h"
#include "capture/streams/osc.h"

#include <array>
#include <cstddef>
#include <cstdint>
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
  void applyExpressions();
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

}  // namespace lorica
