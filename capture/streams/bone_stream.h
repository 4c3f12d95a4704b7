#pragma once

#include "capture/retarget/bone_pose.h"
#include "capture/skeleton_frame.h"

#include <vector>

namespace lorica {

/// What a sender said up to one moment.
struct BoneFrame {
  double time = 0.0;  ///< when its last packet arrived, in seconds since the stream began
  BonePose pose;
  bool tracking = true;                  ///< false if the sender says that it is not tracking
  std::vector<NamedWeight> expressions;  ///< in the order in which the sender first named them
};

/// A body that another program sends while it moves. Each protocol is one implementation, see docs/STREAMS.md.
class BoneStream {
 public:
  virtual ~BoneStream() = default;

  /// Waits for a frame that is newer than the one of the last call.
  /// @param seconds  at most this long
  /// @param frame    the latest frame, written if there is one
  /// @return whether there is a new one
  [[nodiscard]] virtual bool wait(double seconds, BoneFrame& frame) = 0;
  /// Whether wait() would return at once with a new frame.
  [[nodiscard]] virtual bool ready() const = 0;
  /// Whether there will never be a frame again, as after the last one of a recording.
  [[nodiscard]] virtual bool ended() const { return false; }
  /// Seconds since the stream began.
  [[nodiscard]] virtual double now() const = 0;
};

}  // namespace lorica
