#pragma once

#include "capture/streams/bone_stream.h"
#include "capture/streams/frame_pace.h"
#include "capture/streams/udp.h"
#include "capture/streams/vmc_follower.h"

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace lorica {

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
  ~VmcStream() override;
  VmcStream(const VmcStream&) = delete;
  VmcStream& operator=(const VmcStream&) = delete;

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
  void run();
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
  bool stop_ = false;

  std::thread thread_;
};

}  // namespace lorica
