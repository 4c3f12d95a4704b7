#include "capture/sensor/depth_recording.h"
#include "capture/sensor/oni_depth_codec.h"
#include "geometry/descriptor.h"
#include "geometry/errors.h"
#include "geometry/little_endian.h"
#include "geometry/new_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

// The records that docs/SENSORS.md has in a table, of one device and one depth stream.

namespace lorica {
namespace {

constexpr std::uint32_t kOniDevice = 1, kOniDepth = 2;  // types of nodes, here their numbers, too
constexpr int kLargestOni = 2048;                       // pixels a side, as it is read

template <typename... T>
std::string oniNumbers(T... values) {
  std::string bytes;
  (appendLittleEndian(values, bytes), ...);
  return bytes;
}

std::string oniText(std::string_view text) {
  return oniNumbers(static_cast<std::uint32_t>(text.size() + 1)).append(text) + '\0';
}

std::string oniRecord(std::uint32_t type, std::uint32_t node, std::string_view fields, std::string_view payload = {}) {
  constexpr std::uint32_t kHead = 28;
  return std::string("NIR\0", 4) + oniNumbers(type, node, static_cast<std::uint32_t>(kHead + fields.size()),
                                              static_cast<std::uint32_t>(payload.size()), std::uint64_t{0})
                                       .append(fields)
                                       .append(payload);
}

std::string oniNode(std::uint32_t type, OniCodec codec, std::string_view name, std::uint32_t frames, std::uint64_t from,
                    std::uint64_t to) {
  return oniRecord(
      13, type,
      oniText(name) + oniNumbers(type, static_cast<std::uint32_t>(codec), frames, from, to, std::uint64_t{0}));
}

std::string oniProperty(std::uint32_t type, std::uint32_t node, std::string_view name, const std::string& value) {
  return oniRecord(type, node, oniText(name) + oniNumbers(static_cast<std::uint32_t>(value.size())) + value);
}

std::string oniNumber(std::string_view name, std::uint64_t value) {
  return oniProperty(3, kOniDepth, name, oniNumbers(value));
}

std::uint64_t microseconds(double time) {
  return static_cast<std::uint64_t>(std::llround(1e6 * time));
}

/// What stands before the images. Its size does not depend on their number.
/// @param last  time of the last image [us]
std::string oniBeginning(const DepthCamera& camera, const std::string& device, std::uint32_t frames,
                         std::uint64_t last) {
  const auto width = static_cast<std::uint32_t>(camera.width), height = static_cast<std::uint32_t>(camera.height);
  const double rate = last > 0 ? 1e6 * (frames - 1) / static_cast<double>(last) : 30.0;
  return "NI10" + oniNumbers(std::uint8_t{1}, std::uint8_t{0}, std::uint16_t{1}, std::uint32_t{0}, last, kOniDepth) +
         oniNode(kOniDevice, OniCodec::kRaw, "Device", 0, 0, 0) +
         oniProperty(5, kOniDevice, "DeviceName", device + '\0') + oniRecord(9, kOniDevice, {}) +
         oniNode(kOniDepth, OniCodec::kTable, "Depth", frames, 0, last) +
         oniNumber("oniRequiredFrameSize", std::uint64_t{2} * width * height) + oniNumber("xnIsGenerating", 1) +
         oniNumber("xnDeviceMaxDepth", 65535) +
         oniProperty(6, kOniDepth, "xnMapOutputMode",
                     oniNumbers(width, height, static_cast<std::uint32_t>(std::clamp(std::lround(rate), 1L, 1000L)))) +
         oniNumber("xnPixelFormat", 4) + oniNumber("oniPixelFormat", 100) +
         oniProperty(6, kOniDepth, "xnFOV", oniNumbers(camera.horizontalFov, camera.verticalFov)) +
         oniNumber("Cropping", 1) + oniProperty(6, kOniDepth, "xnCropping", std::string(12, '\0')) +
         oniNumber("xnMirror", 0) + oniRecord(9, kOniDepth, {}) +
         oniRecord(8, kOniDepth, oniNumbers(~std::uint32_t{0}, ~std::uint64_t{0}));
}

/// @param time    since the first image [s]
/// @param packed  see packOniDepth()
std::string oniImage(double time, std::uint32_t number, std::string_view packed) {
  return oniRecord(10, kOniDepth, oniNumbers(microseconds(time), number), packed);
}

std::string oniEnd() {
  return oniRecord(7, kOniDepth, {}) + oniRecord(11, 0, {});
}

Result<void> checkOniSize(const DepthSource& source) {
  const DepthCamera& camera = source.camera();
  if (camera.width <= kLargestOni && camera.height <= kLargestOni) return {};
  return unsupported("{}: found images of {} x {}, expected at most {} pixels a side for .oni", source.name(),
                     camera.width, camera.height, kLargestOni);
}

}  // namespace

Result<void> writeOni(DepthRecording& recording, const std::filesystem::path& file,
                      const std::function<bool(int)>& progress) {
  LORICA_TRY_DO(checkOniSize(recording));
  const DepthRecordingInfo& about = recording.about();
  const auto frames = static_cast<std::uint32_t>(about.frameCount);
  LORICA_TRY(const std::unique_ptr<NewFile> out, NewFile::create(file));
  LORICA_TRY_DO(out->write(oniBeginning(recording.camera(), about.device.empty() ? about.format : about.device, frames,
                                        microseconds(about.duration))));
  recording.seek(0);
  DepthFrame frame;
  double begin = 0.0;
  for (std::uint32_t number = 1; number <= frames; ++number) {
    LORICA_TRY_DO(recording.next(frame));
    if (number == 1) begin = frame.time;
    LORICA_TRY_DO(out->write(oniImage(frame.time - begin, number, packOniDepth(OniCodec::kTable, frame.depthMm))));
    if (progress && !progress(static_cast<int>(number))) return cancelled();
  }
  LORICA_TRY_DO(out->write(oniEnd()));
  return out->finish();
}

namespace {

class OniRecorder final : public DepthRecorder {
 public:
  OniRecorder(DepthSource& source, std::filesystem::path target, const RecordingLimits& limits)
      : source_(source),
        limits_(limits),
        target_(std::move(target)),
        beside_(std::filesystem::path(target_).replace_extension(".part.oni")) {}
  ~OniRecorder() override { stop(); }
  OniRecorder(const OniRecorder&) = delete;
  OniRecorder& operator=(const OniRecorder&) = delete;

  Result<void> start();
  [[nodiscard]] const DepthCamera& camera() const override { return source_.camera(); }
  [[nodiscard]] std::string name() const override { return source_.name(); }
  Result<DepthRead> next(DepthFrame& frame) override;
  void stop() override;
  [[nodiscard]] const std::optional<std::filesystem::path>& found() const override { return found_; }
  Result<int> finish() override;
  void discard() override;

 private:
  struct Image {
    double time;        // in the source's clock [s]
    off_t at;           // where its packed depths begin
    std::size_t bytes;  // packed
  };

  void receive();
  /// @return whether more is wanted
  Result<bool> write(const DepthFrame& frame);
  [[nodiscard]] std::string beginning(std::uint32_t frames, std::uint64_t last) const {
    return oniBeginning(source_.camera(), source_.name(), frames, last);
  }

  DepthSource& source_;
  const RecordingLimits limits_;
  const std::filesystem::path target_, beside_;
  std::optional<std::filesystem::path> found_;
  Descriptor file_{-1};    // for appending, of the thread
  Descriptor reread_{-1};  // for reading
  off_t size_ = 0;         // of the thread
  std::size_t read_ = 0;   // images that were given
  std::vector<std::uint8_t> packed_;
  OniDepthDecoder decoder_;

  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::vector<Image> images_;
  std::optional<Error> error_;
  bool unplugged_ = false;  // and that was not told yet
  bool stopped_ = false, ended_ = false;
  std::thread thread_;
};

Result<void> OniRecorder::start() {
  LORICA_TRY_DO(checkOniSize(source_));
  LORICA_TRY(std::optional<std::filesystem::path> found, keepFound(beside_));
  found_ = std::move(found);
  LORICA_TRY(const int created, createPart(beside_));
  file_.reset(created);
  reread_.reset(::open(beside_.c_str(), O_RDWR | O_CLOEXEC));
  const std::string begin = beginning(0, 0);
  if (const int error = reread_.valid() ? writeAll(file_.get(), begin) : errno; error != 0) {
    discard();
    return unwritable(beside_, error);
  }
  size_ = static_cast<off_t>(begin.size());
  thread_ = std::thread([this] { receive(); });
  return {};
}

/// Runs on the thread of its own.
void OniRecorder::receive() {
  DepthFrame frame;
  for (bool more = true; more;) {
    Result<DepthRead> read = source_.next(frame);
    Result<bool> wanted = true;
    if (read && *read == DepthRead::kFrame) wanted = write(frame);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!read) error_ = read.error();
    if (!wanted) error_ = wanted.error();
    unplugged_ |= read && *read == DepthRead::kUnplugged;
    more = !stopped_ && !error_ && *wanted && *read != DepthRead::kEnd;
    ended_ = !more;
    changed_.notify_all();
  }
}

Result<bool> OniRecorder::write(const DepthFrame& frame) {
  const double begin = images_.empty() ? frame.time : images_.front().time;
  const std::string packed = packOniDepth(OniCodec::kTable, frame.depthMm);
  const std::string record = oniImage(frame.time - begin, static_cast<std::uint32_t>(images_.size() + 1), packed);
  if (const int error = writeAll(file_.get(), record); error != 0) return unwritable(beside_, error);
  size_ += static_cast<off_t>(record.size());
  const std::lock_guard<std::mutex> lock(mutex_);
  images_.push_back({frame.time, size_ - static_cast<off_t>(packed.size()), packed.size()});
  return !(limits_.frames > 0 && std::ssize(images_) >= limits_.frames) &&
         !(limits_.seconds > 0.0 && frame.time - begin >= limits_.seconds);
}

Result<DepthRead> OniRecorder::next(DepthFrame& frame) {
  Image image{};
  {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_for(lock, std::chrono::milliseconds(100),
                      [&] { return read_ < images_.size() || unplugged_ || ended_; });
    if (read_ == images_.size()) {
      if (std::exchange(unplugged_, false)) return DepthRead::kUnplugged;
      if (error_) return *error_;
      return ended_ ? DepthRead::kEnd : DepthRead::kWaiting;
    }
    image = images_[read_++];
  }
  packed_.resize(image.bytes);
  const ssize_t got = ::pread(reread_.get(), packed_.data(), packed_.size(), image.at);
  if (got != std::ssize(packed_))
    return unreadable("{}: an image that was just written is not there", beside_.string());
  const DepthCamera& camera = source_.camera();
  frame.time = image.time;
  frame.depthMm.resize(static_cast<std::size_t>(camera.width) * camera.height);
  LORICA_TRY_DO(prefixed(beside_.string(), decoder_.decode(OniCodec::kTable, packed_, frame.depthMm)));
  return DepthRead::kFrame;
}

void OniRecorder::stop() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopped_ = true;
  }
  if (thread_.joinable()) thread_.join();
}

Result<int> OniRecorder::finish() {
  stop();
  const auto frames = static_cast<std::uint32_t>(images_.size());
  const std::uint64_t last = images_.empty() ? 0 : microseconds(images_.back().time - images_.front().time);
  const std::string begin = beginning(frames, last);
  int error = writeAll(file_.get(), oniEnd());
  if (error == 0 && ::pwrite(reread_.get(), begin.data(), begin.size(), 0) != std::ssize(begin)) error = errno;
  if (error == 0 && ::fsync(file_.get()) != 0) error = errno;
  if (error != 0) return unwritable(beside_, error);
  std::error_code renamed;
  std::filesystem::rename(beside_, target_, renamed);
  if (renamed) return unwritable(target_, renamed.value());
  file_.close();
  return static_cast<int>(frames);
}

void OniRecorder::discard() {
  stop();
  (void)::unlink(beside_.c_str());
  file_.close();
}

}  // namespace

Result<std::unique_ptr<DepthRecorder>> DepthRecorder::start(DepthSource& source, const std::filesystem::path& file,
                                                            const RecordingLimits& limits) {
  auto recorder = std::make_unique<OniRecorder>(source, file, limits);
  LORICA_TRY_DO(recorder->start());
  return std::unique_ptr<DepthRecorder>(std::move(recorder));
}

}  // namespace lorica
