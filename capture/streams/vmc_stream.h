#pragma once

#include "capture/streams/bone_stream.h"
#include "capture/streams/udp.h"
#include "capture/streams/vmc_receiver.h"

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace lorica {

/// Listens for VMC packets on its own thread. Follows one sender: the first, and another one when that was silent for
/// half a second.
class VmcStream final : public BoneStream {
 public:
  struct Counts {
    std::int64_t packets = 0;  ///< of the followed sender
    std::int64_t refused = 0;  ///< of these, packets that were not understood
    std::int64_t others = 0;   ///< packets of other senders
    std::int64_t frames = 0;
    double jitter = 0.0;  ///< mean deviation of the time between frames from its mean [s]
  };

  /// Starts to listen.
  explicit VmcStream(UdpSocket socket);
  ~VmcStream() override;
  VmcStream(const VmcStream&) = delete;
  VmcStream& operator=(const VmcStream&) = delete;

  [[nodiscard]] bool wait(double seconds, BoneFrame& frame) override;
  [[nodiscard]] bool ready() const override;
  [[nodiscard]] double now() const override;

  /// The expressions of the last frame that wait() gave.
  void readExpressions(std::vector<VmcExpression>& expressions) const;
  [[nodiscard]] Counts counts() const;
  /// BoneFrame::time of the last frame that wait() gave; none before the first.
  [[nodiscard]] std::optional<double> lastTime() const;
  /// The sender's avatar as it reports it; empty if it does not.
  [[nodiscard]] std::string title() const;

 private:
  void run();
  void publish(double seconds);

  UdpSocket socket_;      ///< used by the thread only
  VmcReceiver receiver_;  ///< used by the thread only
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  BoneFrame latest_;
  std::vector<VmcExpression> expressions_;
  std::string title_;
  Counts counts_;
  std::int64_t given_ = 0;  ///< frames up to the last that wait() gave
  std::optional<double> givenTime_;
  double meanStep_ = 0.0;
  std::optional<double> lastFrame_;
  bool stop_ = false;

  std::thread thread_;
};

}  // namespace lorica
