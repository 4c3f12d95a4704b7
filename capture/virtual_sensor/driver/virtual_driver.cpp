/// An OpenNI2 driver with one depth camera, lorica://virtual, that shows simulated people: see
/// capture/virtual_sensor/virtual_script.h for its settings, and docs/VIRTUAL_SENSOR.md. And with cameras
/// lorica://depth/ADDRESS, which show what another program sends, see capture/streams/depth_stream.h.

#include "capture/streams/depth_stream.h"
#include "capture/virtual_sensor/virtual_script.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

// The driver header expects these macros of XnLib, which is not packaged.
#define XN_NEW(type, argument) new type(argument)
#define XN_DELETE(pointer) delete (pointer)
#define XN_MAX_UINT16 65535
#ifndef TRUE
#define TRUE 1
#define FALSE 0
#endif
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#include <Driver/OniDriverAPI.h>
#pragma GCC diagnostic pop

namespace lorica {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kUri = "lorica://virtual";
constexpr std::string_view kSentUri = "lorica://depth/";            ///< and an address as of DepthStreamSettings::at
constexpr const char* kSentVariable = "LORICA_DEPTH";               ///< such an address: that camera instead of people
constexpr const char* kSentFormatVariable = "LORICA_DEPTH_FORMAT";  ///< of bare images, see parseBareDepth()
/// Above every depth value: the recorder sizes a table by it, in millimetres.
constexpr int kMaxDepth = 10000;

OniDeviceInfo deviceInfo(const char* uri = kUri, const char* name = "Virtual depth camera") {
  OniDeviceInfo info{};
  std::snprintf(info.uri, sizeof(info.uri), "%s", uri);
  std::snprintf(info.vendor, sizeof(info.vendor), "Lorica");
  std::snprintf(info.name, sizeof(info.name), "%s", name);
  return info;
}

OniVideoMode videoModeOf(const DepthCamera& camera, double framesPerSecond) {
  return {ONI_PIXEL_FORMAT_DEPTH_1_MM, camera.width, camera.height, static_cast<int>(std::lround(framesPerSecond))};
}

OniVideoMode videoModeOf(const VirtualScript& script) {
  return videoModeOf(script.settings.camera, script.settings.framesPerSecond);
}

/// Copies a value to OpenNI2, whose buffer must have the value's size.
template <typename Value>
OniStatus give(const Value& value, void* data, int* size) {
  if (data == nullptr || size == nullptr || *size != int{sizeof(Value)}) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof(Value));
  return ONI_STATUS_OK;
}

/// Accepts a value only if it equals the current one.
template <typename Value>
OniStatus accept(const Value& only, const void* data, int size) {
  if (data == nullptr || size != int{sizeof(Value)}) return ONI_STATUS_BAD_PARAMETER;
  return std::memcmp(data, &only, sizeof(Value)) == 0 ? ONI_STATUS_OK : ONI_STATUS_NOT_SUPPORTED;
}

/// Starts a thread. @return false if the system cannot create one
template <typename Work>
bool run(std::thread& thread, Work work) {
  try {
    thread = std::thread(work);
    return true;
  } catch (const std::system_error&) {
    return false;
  }
}

/// State shared by all streams: the script and the time, which starts when the first stream starts and continues while
/// the camera is closed or unplugged.
class Timeline {
 public:
  explicit Timeline(VirtualScript script) : script_(std::move(script)) {}

  [[nodiscard]] const VirtualScript& script() const { return script_; }

  /// A sensor of the script, created on first use.
  [[nodiscard]] Result<VirtualSensor> sensor() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!sensor_) {
      LORICA_TRY(VirtualSensor made, makeVirtualSensor(script_));
      sensor_.emplace(std::move(made));
    }
    return *sensor_;
  }

  void begin() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (begin_) return;
    begin_ = Clock::now();
    changed_.notify_all();
  }

  /// Waits until the next frame is due, or not at all if the pace is fast.
  /// @return its number; nullopt if stop(stopped) was called
  std::optional<std::uint64_t> nextFrame(const bool& stopped) {
    std::unique_lock<std::mutex> lock(mutex_);
    if (stopped || !begin_) return std::nullopt;
    if (script_.settings.live) {
      const double passed = std::chrono::duration<double>(Clock::now() - *begin_).count();
      next_ = std::max<std::uint64_t>(next_, passed * script_.settings.framesPerSecond);
      const Clock::time_point due = timeOf(next_ / script_.settings.framesPerSecond);
      if (changed_.wait_until(lock, due, [&] { return stopped; })) return std::nullopt;
    }
    return next_++;
  }

  /// Waits for a time of the sensor. @return false if stop(stopped) was called
  bool waitFor(double seconds, const bool& stopped) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return stopped || begin_; });
    return !stopped && !changed_.wait_until(lock, timeOf(seconds), [&] { return stopped; });
  }

  void stop(bool& stopped) {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopped = true;
    changed_.notify_all();
  }

 private:
  [[nodiscard]] Clock::time_point timeOf(double seconds) const {
    return *begin_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }

  VirtualScript script_;
  std::mutex mutex_;
  std::optional<VirtualSensor> sensor_;
  std::condition_variable changed_;
  std::optional<Clock::time_point> begin_;
  std::uint64_t next_ = 0;
};

/// A stream to OpenNI2, of frames that a thread makes.
class FrameStream : public oni::driver::StreamBase {
 public:
  FrameStream(const DepthCamera& camera, const OniVideoMode& mode) : camera_(camera), mode_(mode) {}

  OniStatus start() override {
    if (thread_.joinable()) return ONI_STATUS_OK;
    begin();
    return run(thread_, [this] { produce(); }) ? ONI_STATUS_OK : ONI_STATUS_ERROR;
  }
  void stop() override { end(); }

  OniBool isPropertySupported(int property) override {
    return getProperty(property, nullptr, nullptr) == ONI_STATUS_NOT_SUPPORTED ? FALSE : TRUE;
  }

  OniStatus getProperty(int property, void* data, int* size) override {
    switch (property) {
      // Without an answer here the stock player drops every frame of a recording.
      case ONI_STREAM_PROPERTY_CROPPING:
        return lorica::give(OniCropping{FALSE, 0, 0, camera_.width, camera_.height}, data, size);
      case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
        return lorica::give(static_cast<float>(camera_.horizontalFov), data, size);
      case ONI_STREAM_PROPERTY_VERTICAL_FOV:
        return lorica::give(static_cast<float>(camera_.verticalFov), data, size);
      case ONI_STREAM_PROPERTY_VIDEO_MODE:
        return lorica::give(mode_, data, size);
      case ONI_STREAM_PROPERTY_MAX_VALUE:
        return lorica::give(kMaxDepth, data, size);
      case ONI_STREAM_PROPERTY_MIN_VALUE:
        return lorica::give(0, data, size);
      case ONI_STREAM_PROPERTY_STRIDE:
        return lorica::give(stride(), data, size);
      case ONI_STREAM_PROPERTY_MIRRORING:
        return lorica::give(static_cast<OniBool>(FALSE), data, size);
      default:
        return ONI_STATUS_NOT_SUPPORTED;
    }
  }

  OniStatus setProperty(int property, const void* data, int size) override {
    switch (property) {
      case ONI_STREAM_PROPERTY_VIDEO_MODE:
        return accept(mode_, data, size);
      case ONI_STREAM_PROPERTY_MIRRORING:
        return accept(static_cast<OniBool>(FALSE), data, size);
      default:
        return ONI_STATUS_NOT_SUPPORTED;
    }
  }

  void notifyAllProperties() override {
    notify<float>({ONI_STREAM_PROPERTY_HORIZONTAL_FOV, ONI_STREAM_PROPERTY_VERTICAL_FOV});
    notify<int>({ONI_STREAM_PROPERTY_MAX_VALUE, ONI_STREAM_PROPERTY_MIN_VALUE, ONI_STREAM_PROPERTY_STRIDE,
                 ONI_STREAM_PROPERTY_MIRRORING});
    raisePropertyChanged(ONI_STREAM_PROPERTY_VIDEO_MODE, &mode_, sizeof(mode_));
  }

 protected:
  virtual void begin() = 0;
  virtual void produce() = 0;  ///< until askToEnd(); on the thread
  virtual void askToEnd() = 0;

  /// To be called by the destructor of what is derived.
  void end() {
    askToEnd();
    if (thread_.joinable()) thread_.join();
  }

  /// @param number  from 0
  void give(const DepthFrame& image, int number) {
    OniFrame* frame = getServices().acquireFrame();
    if (frame == nullptr) return;
    const std::size_t bytes = image.depthMm.size() * sizeof(std::uint16_t);
    if (frame->dataSize >= static_cast<int>(bytes)) {
      std::memcpy(frame->data, image.depthMm.data(), bytes);
      frame->dataSize = bytes;
      frame->sensorType = ONI_SENSOR_DEPTH;
      frame->timestamp = std::llround(1e6 * image.time);
      frame->frameIndex = number + 1;
      frame->width = camera_.width;
      frame->height = camera_.height;
      frame->videoMode = mode_;
      frame->croppingEnabled = FALSE;
      frame->cropOriginX = frame->cropOriginY = 0;
      frame->stride = stride();
      raiseNewFrame(frame);
    }
    getServices().releaseFrame(frame);
  }

 private:
  template <typename Value>
  void notify(std::initializer_list<int> properties) {
    for (const int property : properties) {
      Value value{};
      int size = sizeof(value);
      if (getProperty(property, &value, &size) == ONI_STATUS_OK) raisePropertyChanged(property, &value, size);
    }
  }

  [[nodiscard]] int stride() const { return camera_.width * int{sizeof(std::uint16_t)}; }

  DepthCamera camera_;
  OniVideoMode mode_;
  std::thread thread_;
};

class VirtualStream final : public FrameStream {
 public:
  VirtualStream(Timeline& timeline, VirtualSensor sensor)
      : FrameStream(sensor.camera(), videoModeOf(timeline.script())), timeline_(timeline), sensor_(std::move(sensor)) {}
  ~VirtualStream() override { end(); }

 private:
  void begin() override {
    stopped_ = false;
    timeline_.begin();
  }
  void askToEnd() override { timeline_.stop(stopped_); }

  void produce() override {
    while (const std::optional<std::uint64_t> number = timeline_.nextFrame(stopped_)) {
      if (!timeline_.script().settings.loop && *number >= sensor_.frameCount()) return;
      const double time = *number / timeline_.script().settings.framesPerSecond;
      const std::vector<TimeSpan>& away = timeline_.script().settings.unplugged;
      if (std::any_of(away.begin(), away.end(), [&](const TimeSpan& span) { return span.holds(time); })) continue;
      sensor_.render(*number, image_);
      give(image_, static_cast<int>(*number));
    }
  }

  Timeline& timeline_;
  VirtualSensor sensor_;
  DepthFrame image_;
  bool stopped_ = false;  ///< guarded by the timeline
};

/// What another program sends.
class SentStream final : public FrameStream {
 public:
  SentStream(DepthStream& source, const OniVideoMode& mode, oni::driver::DriverServices& services)
      : FrameStream(source.camera(), mode), source_(source), services_(services) {}
  ~SentStream() override { end(); }

 private:
  void begin() override { stopped_ = false; }
  void askToEnd() override { stopped_ = true; }

  void produce() override {
    for (int number = 0; !stopped_;) {
      const Result<DepthRead> read = source_.next(image_);
      if (!read) return services_.errorLoggerAppend("%s", read.error().message.c_str());
      if (*read != DepthRead::kFrame) continue;
      for (std::uint16_t& depth : image_.depthMm) depth = depth < kMaxDepth ? depth : 0;
      give(image_, number++);
    }
  }

  DepthStream& source_;
  oni::driver::DriverServices& services_;
  DepthFrame image_;
  std::atomic<bool> stopped_ = false;
};

class Device : public oni::driver::DeviceBase {
 public:
  Device(const OniVideoMode& mode, oni::driver::DriverServices& services) : services_(services), mode_(mode) {
    sensor_ = {ONI_SENSOR_DEPTH, 1, &mode_};
  }

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = &sensor_;
    *count = 1;
    return ONI_STATUS_OK;
  }

  oni::driver::StreamBase* createStream(OniSensorType type) override {
    return type == ONI_SENSOR_DEPTH ? makeStream() : nullptr;
  }
  void destroyStream(oni::driver::StreamBase* stream) override { delete stream; }

  OniBool isPropertySupported(int property) override {
    return getProperty(property, nullptr, nullptr) == ONI_STATUS_NOT_SUPPORTED ? FALSE : TRUE;
  }
  OniStatus getProperty(int property, void* data, int* size) override {
    switch (property) {
      case ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION:
        return give(ONI_IMAGE_REGISTRATION_OFF, data, size);
      case ONI_DEVICE_PROPERTY_DRIVER_VERSION:
        return give(OniVersion{0, 1, 0, 0}, data, size);
      default:
        return ONI_STATUS_NOT_SUPPORTED;
    }
  }
  OniStatus setProperty(int property, const void* data, int size) override {
    if (property == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return accept(ONI_IMAGE_REGISTRATION_OFF, data, size);
    return ONI_STATUS_NOT_SUPPORTED;
  }

 protected:
  virtual oni::driver::StreamBase* makeStream() = 0;

  oni::driver::DriverServices& services_;
  OniVideoMode mode_;

 private:
  OniSensorInfo sensor_{};
};

class VirtualDevice final : public Device {
 public:
  VirtualDevice(Timeline& timeline, oni::driver::DriverServices& services)
      : Device(videoModeOf(timeline.script()), services), timeline_(timeline) {}

 private:
  oni::driver::StreamBase* makeStream() override {
    Result<VirtualSensor> sensor = timeline_.sensor();
    if (sensor) return new VirtualStream(timeline_, std::move(*sensor));
    services_.errorLoggerAppend("%s", sensor.error().message.c_str());
    return nullptr;
  }

  Timeline& timeline_;
};

class SentDevice final : public Device {
 public:
  SentDevice(std::unique_ptr<DepthStream> source, oni::driver::DriverServices& services)
      : Device(videoModeOf(source->camera(), 30.0), services), source_(std::move(source)) {}

 private:
  oni::driver::StreamBase* makeStream() override { return new SentStream(*source_, mode_, services_); }

  std::unique_ptr<DepthStream> source_;
};

/// Waits for the program that sends.
Result<std::unique_ptr<DepthStream>> openSent(std::string_view address) {
  DepthStreamSettings settings;
  settings.at = address;
  const char* format = std::getenv(kSentFormatVariable);
  if (format != nullptr && *format != '\0') {
    LORICA_TRY(settings.bare, parseBareDepth(format));
  }
  return DepthStream::open(settings);
}

class VirtualDriver final : public oni::driver::DriverBase {
 public:
  explicit VirtualDriver(OniDriverServices* services) : DriverBase(services) {}
  ~VirtualDriver() override { end(); }

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback stateChanged, void* cookie) override {
    DriverBase::initialize(connected, disconnected, stateChanged, cookie);
    const char* sent = std::getenv(kSentVariable);
    if (sent != nullptr && *sent != '\0') return tryDevice((std::string(kSentUri) + sent).c_str());
    const char* text = std::getenv(kVirtualScriptVariable);
    Result<VirtualScript> script = parseVirtualScript(text != nullptr ? text : "");
    if (!script) {
      getServices().errorLoggerAppend("%s", script.error().message.c_str());
      return ONI_STATUS_ERROR;
    }
    timeline_ = std::make_unique<Timeline>(std::move(*script));
    connect();
    const bool plugging = !timeline_->script().settings.unplugged.empty();
    return !plugging || run(thread_, [this] { plug(); }) ? ONI_STATUS_OK : ONI_STATUS_ERROR;
  }

  oni::driver::DeviceBase* deviceOpen(const char* uri, const char* /*mode*/) override {
    if (uri != nullptr && std::string_view(uri).starts_with(kSentUri)) {
      Result<std::unique_ptr<DepthStream>> source = openSent(std::string_view(uri).substr(kSentUri.size()));
      if (source) return new SentDevice(std::move(*source), getServices());
      getServices().errorLoggerAppend("%s", source.error().message.c_str());
      return nullptr;
    }
    if (timeline_ == nullptr || uri == nullptr || std::strcmp(uri, kUri) != 0) return nullptr;
    if (!connected_) {
      getServices().errorLoggerAppend("%s is unplugged", kUri);
      return nullptr;
    }
    return new VirtualDevice(*timeline_, getServices());
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }
  /// The virtual camera reports itself through connect(); a program that sends is known by its address only.
  OniStatus tryDevice(const char* uri) override {
    if (uri == nullptr || !std::string_view(uri).starts_with(kSentUri)) return ONI_STATUS_ERROR;
    const OniDeviceInfo info = deviceInfo(uri, "Depth from another program");
    deviceConnected(&info);
    return ONI_STATUS_OK;
  }
  void shutdown() override { end(); }

 private:
  void connect() {
    const OniDeviceInfo info = deviceInfo();
    connected_ = true;
    deviceConnected(&info);
  }

  /// Unplugs the camera and plugs it in again according to the script.
  void plug() {
    const OniDeviceInfo info = deviceInfo();
    for (const TimeSpan& away : timeline_->script().settings.unplugged) {
      if (!timeline_->waitFor(away.from, stopped_)) return;
      connected_ = false;
      deviceDisconnected(&info);
      if (!timeline_->waitFor(away.to, stopped_)) return;
      connect();
    }
  }

  void end() {
    if (timeline_ != nullptr) timeline_->stop(stopped_);
    if (thread_.joinable()) thread_.join();
  }

  std::unique_ptr<Timeline> timeline_;
  std::atomic<bool> connected_ = false;
  bool stopped_ = false;  ///< guarded by the timeline
  std::thread thread_;
};

}  // namespace
}  // namespace lorica

ONI_EXPORT_DRIVER(lorica::VirtualDriver)
