#include "capture/streams/depth_stream.h"

#include "capture/streams/udp.h"
#include "geometry/descriptor.h"
#include "geometry/errors.h"
#include "geometry/interrupt.h"
#include "geometry/text.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

namespace lorica {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kShortWait = std::chrono::milliseconds(100);  // as DepthSource::next() waits at most
constexpr double kClocksAgree = 1.0;                         // [s]

enum class Way { kInput, kPath, kPort };

Way wayOf(const std::string& at) {
  if (at == "-") return Way::kInput;
  if (at.find('/') != std::string::npos) return Way::kPath;
  const bool digits = std::ranges::all_of(at, [](char c) { return c >= '0' && c <= '9'; });
  return at.find(':') != std::string::npos || digits ? Way::kPort : Way::kPath;
}

double since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::string reasonOf(int error) {
  return std::generic_category().message(error);
}

Error noSocket(const std::string& path, int error) {
  return unreadable("{}: cannot listen there: {}", path, reasonOf(error));
}

/// Makes a socket in the file system that this user alone may connect to. One that nobody listens at is replaced.
Result<int> listenAt(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) {
    return invalidArgument("{}: found a path of {} bytes, expected at most {} for a socket", path, path.size(),
                           sizeof address.sun_path - 1);
  }
  std::memcpy(address.sun_path, path.data(), path.size());
  const auto* where = reinterpret_cast<const sockaddr*>(&address);
  struct stat status {};
  if (::lstat(path.c_str(), &status) == 0) {
    const Descriptor probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    if (::connect(probe.get(), where, sizeof address) == 0 || errno != ECONNREFUSED) return noSocket(path, EADDRINUSE);
    (void)::unlink(path.c_str());
  }
  Descriptor made(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  // Between bind() and listen() nobody can connect, so nobody else ever can.
  if (!made.valid() || ::bind(made.get(), where, sizeof address) != 0 ||
      ::chmod(path.c_str(), S_IRUSR | S_IWUSR) != 0 || ::listen(made.get(), 4) != 0) {
    return noSocket(path, errno);
  }
  return made.release();
}

/// A pipe holds 64 kB, an image some ten times as much: with more in it both sides wait less often.
void widen(int pipe) {
  (void)::fcntl(pipe, F_SETPIPE_SZ, 1 << 20);
}

Result<int> openPipe(const std::string& path) {
  const int opened = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (opened < 0) return unreadable("{}: cannot be read: {}", path, reasonOf(errno));
  widen(opened);
  return opened;
}

}  // namespace

std::string depthStreamName(const std::string& at) {
  if (wayOf(at) == Way::kInput) return "standard input";
  if (wayOf(at) == Way::kPath) return printable(at, 200);
  const Result<NetworkAddress> address = parseNetworkAddress(at, false);
  return address ? textOf(*address) : printable(at, 200);
}

namespace {

class DepthReceiver final : public DepthStream {
 public:
  explicit DepthReceiver(const DepthStreamSettings& settings)
      : settings_(settings), way_(wayOf(settings.at)), parser_(settings.bare), wake_(::eventfd(0, EFD_CLOEXEC)) {}
  ~DepthReceiver() override;
  DepthReceiver(const DepthReceiver&) = delete;
  DepthReceiver& operator=(const DepthReceiver&) = delete;

  Result<void> listen();
  Result<void> waitForCamera();
  Result<DepthRead> next(DepthFrame& frame) override;

  /// "depth from 127.0.0.1:7000"
  [[nodiscard]] std::string name() const override { return "depth from " + depthStreamName(settings_.at); }
  [[nodiscard]] const DepthCamera& camera() const override { return rectifier_->camera(); }
  [[nodiscard]] std::uint16_t port() const override { return way_ == Way::kPort ? portOf(listener_.get()) : 0; }
  [[nodiscard]] Counts counts() const override {
    const std::lock_guard<std::mutex> lock(mutex_);
    return counts_;
  }

 private:
  void receive();
  bool readSome();
  void leave();
  void fail(Error error);
  void give();
  double timeOf(double sent, double arrival, std::int64_t sender);

  const DepthStreamSettings settings_;
  const Way way_;
  DepthFrameParser parser_;  // of the thread
  Descriptor wake_;          // ends the thread
  Descriptor listener_{-1};  // sockets only
  Descriptor stream_{-1};    // of the thread once it runs
  Clock::time_point heard_;  // when the sender last said something; of the thread
  const Clock::time_point begin_ = Clock::now();
  bool fifo_ = false;
  bool ownsPath_ = false;

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  Counts counts_;
  std::optional<DepthLens> lens_;
  std::vector<std::uint16_t> newest_;
  bool fresh_ = false;  // whether newest_ was not read yet
  double sent_ = 0.0, arrival_ = 0.0;
  std::int64_t sender_ = 0;
  bool connected_ = false, ended_ = false;
  std::atomic<bool> opened_ = false;  // the camera is known
  std::optional<Error> error_;

  std::optional<DepthRectifier> rectifier_;  // of the reader, as all below
  std::vector<std::uint16_t> raw_;
  bool unitChecked_ = false;
  std::int64_t lastSender_ = 0;
  double lastSent_ = 0.0, lastArrival_ = 0.0, lastTime_ = 0.0;

  std::thread thread_;
};

DepthReceiver::~DepthReceiver() {
  if (thread_.joinable()) {
    const std::uint64_t one = 1;
    (void)!::write(wake_.get(), &one, sizeof one);
    thread_.join();
  }
  if (ownsPath_) (void)::unlink(settings_.at.c_str());
}

Result<void> DepthReceiver::listen() {
  const auto take = [](Descriptor& into, int descriptor) { into.reset(descriptor); };
  if (way_ == Way::kInput) {
    if (::isatty(STDIN_FILENO) != 0)
      return invalidArgument(
          "found a terminal, expected a program that sends depth images: SENDER | lorica live --depth -");
    take(stream_, ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0));
    if (!stream_.valid()) return unreadable("standard input cannot be read: {}", reasonOf(errno));
    widen(stream_.get());
    connected_ = true;
    counts_.senders = 1;
  } else if (way_ == Way::kPort) {
    LORICA_TRY(const NetworkAddress address, parseNetworkAddress(settings_.at, false));
    LORICA_TRY(const int made, listenTcp(address));
    take(listener_, made);
  } else {
    struct stat status {};
    const bool there = ::stat(settings_.at.c_str(), &status) == 0;
    fifo_ = there && S_ISFIFO(status.st_mode);
    if (there && !fifo_ && !S_ISSOCK(status.st_mode)) {
      return invalidArgument("{}: found {}, expected a named pipe (mkfifo), or no file: a socket is made there",
                             settings_.at, S_ISDIR(status.st_mode) ? "a folder" : "a file");
    }
    LORICA_TRY(const int made, fifo_ ? openPipe(settings_.at) : listenAt(settings_.at));
    take(fifo_ ? stream_ : listener_, made);
    ownsPath_ = !fifo_;
  }
  heard_ = Clock::now();
  thread_ = std::thread([this] { receive(); });
  return {};
}

/// Runs on the thread of its own.
void DepthReceiver::receive() {
  for (;;) {
    const double silent = since(heard_);
    const bool within = parser_.within();
    const bool listens = listener_.valid() && (!stream_.valid() || silent >= settings_.silence);
    double wait = -1.0;  // for as long as it takes
    if (stream_.valid() && within) wait = std::max(settings_.stall - silent, 0.0);
    if (stream_.valid() && listener_.valid() && !listens) {
      const double rest = settings_.silence - silent;
      wait = wait < 0.0 ? rest : std::min(wait, rest);
    }
    std::array<pollfd, 3> files = {
        {{wake_.get(), POLLIN, 0}, {stream_.get(), POLLIN, 0}, {listens ? listener_.get() : -1, POLLIN, 0}}};
    const int ready = ::poll(files.data(), files.size(), wait < 0.0 ? -1 : static_cast<int>(std::ceil(1e3 * wait)));
    if (files[0].revents != 0) return;
    if (ready < 0 && errno != EINTR) return fail(unreadable("cannot wait for it: {}", reasonOf(errno)));
    if (files[2].revents != 0) {
      if (const int came = ::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK); came >= 0) {
        leave();
        stream_.reset(came);
        heard_ = Clock::now();
        const std::lock_guard<std::mutex> lock(mutex_);
        ++counts_.senders;
        connected_ = true;
      }
    } else if (files[1].revents != 0) {
      if (!readSome()) return;
    } else if (ready == 0 && within && since(heard_) >= settings_.stall) {
      const auto [came, has] = parser_.progress();
      if (way_ == Way::kInput) {
        return fail(badFormat("its sender stopped within an image: found {} of {} bytes, and none for {:g} s", came,
                              has, settings_.stall));
      }
      leave();
      heard_ = Clock::now();
    }
  }
}

/// @return whether to go on
bool DepthReceiver::readSome() {
  const std::span<std::byte> place = parser_.wanted();
  const ssize_t size = ::read(stream_.get(), place.data(), place.size());
  if (size < 0 && (errno == EINTR || errno == EAGAIN)) return true;
  if (size <= 0) {
    if (way_ != Way::kInput) {
      leave();
      return true;
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    counts_.broken += parser_.restart() ? 1 : 0;
    ended_ = true;
    changed_.notify_all();
    return false;
  }
  heard_ = Clock::now();
  if (fifo_ && !connected_) {
    const std::lock_guard<std::mutex> lock(mutex_);
    connected_ = true;
    ++counts_.senders;
  }
  const Result<bool> whole = parser_.got(static_cast<std::size_t>(size));
  if (!whole && listener_.valid() && opened_) {  // nobody else's rubbish ends a session
    leave();
    const std::lock_guard<std::mutex> lock(mutex_);
    ++counts_.refused;
    return true;
  }
  if (!whole) {
    fail(whole.error());
    return false;
  }
  if (*whole) give();
  if (!*whole && !lens_ && parser_.lens()) {
    const std::lock_guard<std::mutex> lock(mutex_);
    lens_ = parser_.lens();
    changed_.notify_all();
  }
  return true;
}

/// The sender is gone; the next may come.
void DepthReceiver::leave() {
  if (fifo_) {
    // Opened again before it is closed: a sender that comes meanwhile finds a reader.
    const Result<int> again = openPipe(settings_.at);
    if (again) {
      stream_.reset(*again);
    } else {
      stream_.close();  // it was deleted: nobody comes any more
    }
  } else {
    stream_.close();
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  counts_.broken += parser_.restart() ? 1 : 0;
  connected_ = false;
  changed_.notify_all();
}

void DepthReceiver::fail(Error error) {
  stream_.close();
  listener_.close();
  const std::lock_guard<std::mutex> lock(mutex_);
  error_ = Error{error.code, name() + ": " + error.message};
  changed_.notify_all();
}

/// An image is complete.
void DepthReceiver::give() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++counts_.images;
  counts_.dropped += fresh_ ? 1 : 0;
  std::swap(newest_, parser_.image());
  fresh_ = true;
  sent_ = parser_.time();
  arrival_ = since(begin_);
  sender_ = counts_.senders;
  changed_.notify_all();
}

Result<void> DepthReceiver::waitForCamera() {
  std::optional<DepthLens> lens = settings_.bare ? std::optional(settings_.bare->lens) : std::nullopt;
  for (std::unique_lock<std::mutex> lock(mutex_); !lens;) {
    changed_.wait_for(lock, kShortWait, [&] { return lens_ || error_ || ended_; });
    if (!lens_ && error_) return *error_;
    if (!lens_ && ended_) return badFormat("{}: found its end, expected depth images", name());
    if (!lens_ && workStopped()) return cancelled();
    lens = lens_;
  }
  LORICA_TRY(rectifier_, prefixed(name(), DepthRectifier::create(*lens)));
  opened_ = true;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!fresh_) newest_.reserve(static_cast<std::size_t>(lens->width) * lens->height);
  raw_.reserve(static_cast<std::size_t>(lens->width) * lens->height);
  return {};
}

/// Goes on from the last image by the sender's clock, or by ours where that does not agree.
double DepthReceiver::timeOf(double sent, double arrival, std::int64_t sender) {
  const double here = std::max(arrival - lastArrival_, 1e-6);
  const double there = sent - lastSent_;
  const bool known = lastSender_ == sender && sent >= 0.0 && lastSent_ >= 0.0 && there > 0.0;
  const double step = lastSender_ == 0 ? 0.0 : known && std::abs(there - here) < kClocksAgree ? there : here;
  lastSender_ = sender;
  lastSent_ = sent;
  lastArrival_ = arrival;
  return lastTime_ += step;
}

Result<DepthRead> DepthReceiver::next(DepthFrame& frame) {
  double sent = 0.0, arrival = 0.0;
  std::int64_t sender = 0;
  {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_for(lock, kShortWait, [&] { return fresh_ || error_ || ended_; });
    if (!fresh_) {
      if (error_) return *error_;
      return ended_ ? DepthRead::kEnd : connected_ ? DepthRead::kWaiting : DepthRead::kUnplugged;
    }
    std::swap(raw_, newest_);
    fresh_ = false;
    sent = sent_;
    arrival = arrival_;
    sender = sender_;
  }
  if (!unitChecked_) LORICA_TRY_DO(prefixed(name(), checkDepthUnit(rectifier_->lens(), raw_)));
  unitChecked_ = true;  // later senders have the same camera, or are refused
  frame.time = timeOf(sent, arrival, sender);
  rectifier_->apply(raw_, frame.depthMm);
  return DepthRead::kFrame;
}

}  // namespace

Result<void> DepthStream::check(const DepthStreamSettings& settings) {
  const std::string& at = settings.at;
  if (wayOf(at) == Way::kPort) LORICA_TRY_DO(parseNetworkAddress(at, false));
  if (wayOf(at) == Way::kPath && at.find('/') == std::string::npos && ::access(at.c_str(), F_OK) != 0) {
    return notFound("found '{}', expected -, a path with a / in it, or [HOST:]PORT", printable(at, 100));
  }
  if (settings.bare) LORICA_TRY_DO(DepthRectifier::create(settings.bare->lens));
  return {};
}

Result<std::unique_ptr<DepthStream>> DepthStream::open(const DepthStreamSettings& settings) {
  LORICA_TRY_DO(check(settings));
  auto receiver = std::make_unique<DepthReceiver>(settings);
  LORICA_TRY_DO(receiver->listen());
  LORICA_TRY_DO(receiver->waitForCamera());
  return std::unique_ptr<DepthStream>(std::move(receiver));
}

}  // namespace lorica
