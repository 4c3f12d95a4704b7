#include "capture/streams/vmc_stream.h"

#include "capture/streams/vmc_writer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {
namespace {

/// A sender that is silent for this time gives way to another one [s].
constexpr double kSilentSeconds = 0.5;
/// How long the thread waits for a packet before it looks whether to stop, or whether a frame is complete [s].
constexpr double kPollSeconds = 0.02;
/// Share of a new value in the means of steps and jitter, as RTP computes them (RFC 3550, 6.4.1).
constexpr double kMeanShare = 1.0 / 16.0;

}  // namespace

VmcStream::VmcStream(UdpSocket socket) : socket_(std::move(socket)), thread_([this] { run(); }) {}

VmcStream::~VmcStream() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  thread_.join();
}

double VmcStream::now() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

void VmcStream::run() {
  std::vector<std::byte> memory(kLargestPacket);
  std::optional<std::uint64_t> followed;
  double lastHeard = 0.0;
  while (true) {
    const std::optional<UdpSocket::Packet> packet = socket_.receive(memory, kPollSeconds);
    const double seconds = now();
    bool complete = false;
    if (packet) {
      const bool silent = seconds - lastHeard > kSilentSeconds;
      if (!followed || (silent && *followed != packet->sender)) {
        followed = packet->sender;
        receiver_ = {};
      }
      const bool own = *followed == packet->sender;
      if (own) {
        lastHeard = seconds;
        complete = receiver_.take(std::span(memory).first(packet->size), seconds);
      }
      const std::lock_guard lock(mutex_);
      ++(own ? counts_.packets : counts_.others);
      counts_.refused = receiver_.refusedCount();
    } else {
      complete = receiver_.wait(seconds);
    }
    if (complete) publish(seconds);
    const std::lock_guard lock(mutex_);
    if (stop_) return;
  }
}

void VmcStream::publish(double seconds) {
  const std::lock_guard lock(mutex_);
  latest_ = receiver_.frame();
  const std::span<const VmcExpression> expressions = receiver_.expressions();
  expressions_.assign(expressions.begin(), expressions.end());
  if (title_ != receiver_.title()) title_ = receiver_.title();
  if (lastFrame_) {
    const double step = seconds - *lastFrame_;
    meanStep_ += counts_.frames == 1 ? step : kMeanShare * (step - meanStep_);
    counts_.jitter += kMeanShare * (std::abs(step - meanStep_) - counts_.jitter);
  }
  lastFrame_ = seconds;
  ++counts_.frames;
  changed_.notify_all();
}

bool VmcStream::wait(double seconds, BoneFrame& frame) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return counts_.frames > given_; });
  if (counts_.frames == given_) return false;
  given_ = counts_.frames;
  frame = latest_;
  givenTime_ = latest_.time;
  return true;
}

bool VmcStream::ready() const {
  const std::lock_guard lock(mutex_);
  return counts_.frames > given_;
}

void VmcStream::readExpressions(std::vector<VmcExpression>& expressions) const {
  const std::lock_guard lock(mutex_);
  expressions.assign(expressions_.begin(), expressions_.end());
}

VmcStream::Counts VmcStream::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

std::optional<double> VmcStream::lastTime() const {
  const std::lock_guard lock(mutex_);
  return givenTime_;
}

std::string VmcStream::title() const {
  const std::lock_guard lock(mutex_);
  return title_;
}

}  // namespace lorica
