#pragma once

#include "capture/streams/bone_stream.h"
#include "capture/streams/frame_pace.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace lorica {

/// Frames that arrived and are not given yet: a ring whose memory is kept. The oldest gives way.
class WaitingFrames {
 public:
  struct Waiting {
    BoneFrame frame;
    double due = 0.0;  ///< when it is given [s]
  };

  /// A place for a frame: that of the one before, if this one follows too soon.
  BoneFrame& add(double arrival, FramePace& pace) {
    if (count_ > 0 && arrival < begun_ + kShortestFrame) return at(count_ - 1).frame;
    if (count_ == ring_.size()) (void)take();
    begun_ = arrival;
    lastDue_ = std::max(pace.due(arrival), lastDue_ + kShortestFrame);
    Waiting& place = at(count_++);
    place.due = lastDue_;
    return place.frame;
  }

  /// When the oldest is given; never if none waits [s].
  [[nodiscard]] double due() const { return count_ > 0 ? ring_[first_].due : std::numeric_limits<double>::infinity(); }

  /// Takes the oldest. @return it, until the next frame is added
  const Waiting& take() {
    const Waiting& oldest = ring_[first_];
    first_ = (first_ + 1) % ring_.size();
    --count_;
    return oldest;
  }

 private:
  /// A session takes steps of at least this time: more frames would make its world run faster than the clock [s].
  static constexpr double kShortestFrame = 1.0 / 240.0;

  Waiting& at(std::size_t i) { return ring_[(first_ + i) % ring_.size()]; }

  std::vector<Waiting> ring_ = std::vector<Waiting>(kMaxWaitingFrames);
  std::size_t first_ = 0, count_ = 0;
  double begun_ = -1.0;    ///< when the frame arrived that the last place was for [s]
  double lastDue_ = -1.0;  ///< of the last place
};

}  // namespace lorica
