#include "capture/streams/vmc_stream.h"

#include "capture/streams/vmc_writer.h"

#include <cmath>
#include <utility>

namespace lorica {
namespace {

constexpr double kMeanShare = 1.0 / 16.0;
constexpr double kPause = 0.5;  ///< [s]

/// How long the thread waits for a packet before it looks whether to stop, or whether a frame is complete [s].
constexpr double kPollSeconds = 0.02;

}  // namespace

double FramePace::due(double arrival) {
  if (!last_ || arrival - *last_ > kPause) {
    expected_ = arrival;
  } else {
    const double step = arrival - *last_;
    meanStep_ += meanStep_ == 0.0 ? step : kMeanShare * (step - meanStep_);
    jitter_ += kMeanShare * (std::abs(step - meanStep_) - jitter_);
    expected_ += meanStep_;
    expected_ += kMeanShare * (arrival - expected_);
  }
  last_ = arrival;
  if (delay_ > 0.0 && expected_ + delay_ < arrival) ++late_;
  due_ = std::max({due_, arrival, delay_ > 0.0 ? expected_ + delay_ : arrival});
  return due_;
}

VmcStream::VmcStream(UdpSocket socket, double delay)
    : socket_(std::move(socket)), pace_(delay), thread_([this](const std::stop_token& stop) { run(stop); }) {}

double VmcStream::now() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
}

void VmcStream::run(const std::stop_token& stop) {
  std::vector<std::byte> memory(kLargestPacket);
  while (true) {
    const std::optional<UdpSocket::Packet> packet = socket_.receive(memory, kPollSeconds);
    const double seconds = now();
    const bool complete = packet ? follower_.take(std::span(memory).first(packet->size), packet->sender, seconds)
                                 : follower_.wait(seconds);
    const std::lock_guard lock(mutex_);
    counts_.packets = follower_.packets();
    counts_.others = follower_.others();
    counts_.refused = follower_.refused();
    if (complete) publish();
    if (stop.stop_requested()) return;
  }
}

void VmcStream::publish() {
  const VmcReceiver& receiver = follower_.receiver();
  waiting_.add(receiver.frame().time, pace_) = receiver.frame();
  if (title_ != receiver.title()) title_ = receiver.title();
  ++counts_.frames;
  counts_.jitter = pace_.jitter();
  counts_.late = pace_.late();
  changed_.notify_all();
}

bool VmcStream::wait(double seconds, BoneFrame& frame) {
  std::unique_lock lock(mutex_);
  const double until = now() + seconds;
  while (waiting_.due() > now()) {
    const double left = std::min(until, waiting_.due()) - now();
    if (now() >= until) return false;
    if (left > 0.0) changed_.wait_for(lock, std::chrono::duration<double>(left));
  }
  // Of several that are due the last one is given.
  const WaitingFrames::Waiting* latest = &waiting_.take();
  while (waiting_.due() <= now()) latest = &waiting_.take();
  frame = latest->frame;
  given_ = Given{latest->due, frame.time};
  frame.time = latest->due;
  return true;
}

bool VmcStream::ready() const {
  const std::lock_guard lock(mutex_);
  return waiting_.due() <= now();
}

VmcStream::Counts VmcStream::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

std::optional<VmcStream::Given> VmcStream::lastGiven() const {
  const std::lock_guard lock(mutex_);
  return given_;
}

std::string VmcStream::title() const {
  const std::lock_guard lock(mutex_);
  return title_;
}

}  // namespace lorica
