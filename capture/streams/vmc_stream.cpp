#include "capture/streams/vmc_stream.h"

#include "capture/streams/vmc_writer.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

/// How long the thread waits for a packet before it looks whether to stop, or whether a frame is complete [s].
constexpr double kPollSeconds = 0.02;
/// A session takes steps of at least this time: more frames would make its world run faster than the clock [s].
constexpr double kShortestFrame = 1.0 / 240.0;

}  // namespace

VmcStream::VmcStream(UdpSocket socket, double delay)
    : socket_(std::move(socket)), pace_(delay), waiting_(kMaxWaitingFrames), thread_([this] { run(); }) {}

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
    if (stop_) return;
  }
}

/// A place at the end of the ring; the oldest gives way. That of the frame before, if this one follows too soon.
VmcStream::Waiting& VmcStream::placeFor(double time) {
  if (count_ > 0 && time < begun_ + kShortestFrame) return waiting_[(first_ + count_ - 1) % kMaxWaitingFrames];
  if (count_ == kMaxWaitingFrames) {
    first_ = (first_ + 1) % kMaxWaitingFrames;
    --count_;
  }
  Waiting& place = waiting_[(first_ + count_++) % kMaxWaitingFrames];
  begun_ = time;
  place.due = lastDue_ = std::max(pace_.due(time), lastDue_ + kShortestFrame);
  return place;
}

void VmcStream::publish() {
  const VmcReceiver& receiver = follower_.receiver();
  placeFor(receiver.frame().time).frame = receiver.frame();
  if (title_ != receiver.title()) title_ = receiver.title();
  ++counts_.frames;
  counts_.jitter = pace_.jitter();
  counts_.late = pace_.late();
  changed_.notify_all();
}

bool VmcStream::isDue(double seconds) const {
  return count_ > 0 && waiting_[first_].due <= seconds;
}

bool VmcStream::wait(double seconds, BoneFrame& frame) {
  std::unique_lock lock(mutex_);
  const double until = now() + seconds;
  while (!isDue(now())) {
    const double left = std::min(until, count_ > 0 ? waiting_[first_].due : until) - now();
    if (now() >= until) return false;
    if (left > 0.0) changed_.wait_for(lock, std::chrono::duration<double>(left));
  }
  // Of several that are due the last one is given.
  std::size_t latest = first_;
  while (isDue(now())) {
    latest = first_;
    first_ = (first_ + 1) % kMaxWaitingFrames;
    --count_;
  }
  frame = waiting_[latest].frame;
  given_ = Given{waiting_[latest].due, frame.time};
  frame.time = waiting_[latest].due;
  return true;
}

bool VmcStream::ready() const {
  const std::lock_guard lock(mutex_);
  return isDue(now());
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
