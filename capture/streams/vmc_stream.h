#pragma once

#include "capture/streams/bone_stream.h"
#include "capture/streams/udp.h"
#include "capture/streams/vmc_receiver.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace lorica {

/// Measures the pace of frames that arrive unevenly, and says when to show each to make it even.
///
/// A frame is expected one mean step after the one before, corrected by a sixteenth of what it came earlier or later,
/// as RFC 3550 filters. It is due `delay` after that, and never before it arrives. A pause of half a second begins
/// anew.
class FramePace {
 public:
  /// @param delay  [s]; 0: each frame is due when it arrives
  explicit FramePace(double delay) : delay_(delay) {}

  /// @param arrival  of the next frame; does not decrease [s]
  /// @return when it is due; does not decrease [s]
  double due(double arrival);

  /// Mean deviation of the time between frames from its mean [s].
  [[nodiscard]] double jitter() const { return jitter_; }
  /// Frames that arrived after they should have been shown.
  [[nodiscard]] std::int64_t late() const { return late_; }

 private:
  double delay_;
  std::optional<double> last_;  ///< arrival of the last frame [s]
  double meanStep_ = 0.0;
  double expected_ = 0.0;
  double due_ = 0.0;
  double jitter_ = 0.0;
  std::int64_t late_ = 0;
};

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

/// Listens for VMC packets on its own thread, see VmcFollower. At most 256 frames wait to be taken, and 240 are given a
/// second, whatever is sent: frames that follow each other faster replace the one before.
///
/// With a delay frames are given at an even pace, see FramePace.
class VmcStream final : public BoneStream {
 public:
  struct Counts {
    std::int64_t packets = 0;  ///< of the followed sender
    std::int64_t refused = 0;  ///< of these, packets that were not understood
    std::int64_t others = 0;   ///< packets of other senders
    std::int64_t frames = 0;
    std::int64_t late = 0;  ///< of these, frames that the delay was too short for
    double jitter = 0.0;    ///< mean deviation of the time between frames from its mean [s]
  };

  /// Starts to listen. @param delay  of each frame [s]
  explicit VmcStream(UdpSocket socket, double delay = 0.0);

  [[nodiscard]] bool wait(double seconds, BoneFrame& frame) override;
  [[nodiscard]] bool ready() const override;
  [[nodiscard]] double now() const override;

  [[nodiscard]] Counts counts() const;
  /// When the last frame that wait() gave was given, its BoneFrame::time, and when its last packet arrived [s].
  struct Given {
    double time = 0.0;
    double arrival = 0.0;
  };
  /// None before the first frame.
  [[nodiscard]] std::optional<Given> lastGiven() const;
  /// The sender's avatar as it reports it; empty if it does not.
  [[nodiscard]] std::string title() const;

 private:
  void run(const std::stop_token& stop);
  void publish();

  UdpSocket socket_;      ///< used by the thread only
  VmcFollower follower_;  ///< used by the thread only
  FramePace pace_;        ///< used by the thread only
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  WaitingFrames waiting_;
  std::string title_;
  Counts counts_;
  std::optional<Given> given_;

  std::jthread thread_;  ///< is ended first
};

}  // namespace lorica
