// An OpenNI2 driver for tests. Each file in the folder named by LORICA_TEST_CAMERAS is a camera, plugged in while the
// file exists; the file's content selects a peculiarity: "mirrored", "tenths", "no depth", "small", "bursts". Frame n
// has openni_test_depth(n, pixel) everywhere.

// XnLib, which this header expects, is not packaged.
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(pointer) delete (pointer)
#include <Driver/OniDriverAPI.h>

#include "tests/capture/sensor/openni_test_driver.h"

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <thread>

namespace {

using lorica::test::openNiTestDepth;
using oni::driver::DeviceBase;
using oni::driver::StreamBase;

template <typename T>
OniStatus give(const T& value, void* data, int* size) {
  if (*size != static_cast<int>(sizeof(T))) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof(T));
  return ONI_STATUS_OK;
}

class Stream : public StreamBase {
 public:
  explicit Stream(std::string oddity) : oddity_(std::move(oddity)) {
    mode_ = {oddity_ == "tenths" ? ONI_PIXEL_FORMAT_DEPTH_100_UM : ONI_PIXEL_FORMAT_DEPTH_1_MM, 320, 240, 30};
  }
  ~Stream() override { stop(); }

  OniStatus start() override {
    running_ = true;
    thread_ = std::thread([this] { run(); });
    return ONI_STATUS_OK;
  }
  void stop() override {
    running_ = false;
    if (thread_.joinable()) thread_.join();
  }

  OniStatus getProperty(int property, void* data, int* size) override {
    switch (property) {
      case ONI_STREAM_PROPERTY_VIDEO_MODE:
        return give(mode_, data, size);
      case ONI_STREAM_PROPERTY_CROPPING:
        return give(OniCropping{}, data, size);
      case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
        return give(1.0F, data, size);
      case ONI_STREAM_PROPERTY_VERTICAL_FOV:
        return give(0.75F, data, size);
      case ONI_STREAM_PROPERTY_MAX_VALUE:
        return give(10000, data, size);
      case ONI_STREAM_PROPERTY_MIRRORING:
        return give(mirroring_, data, size);
      case ONI_STREAM_PROPERTY_STRIDE:
        return give(2 * mode_.resolutionX, data, size);
      default:
        return ONI_STATUS_NOT_SUPPORTED;
    }
  }
  OniBool isPropertySupported(int property) override {
    return property <= ONI_STREAM_PROPERTY_MIRRORING ? TRUE : FALSE;
  }
  OniStatus setProperty(int property, const void* data, int) override {
    if (property == ONI_STREAM_PROPERTY_VIDEO_MODE) {
      mode_ = *static_cast<const OniVideoMode*>(data);
      return ONI_STATUS_OK;
    }
    if (property == ONI_STREAM_PROPERTY_MIRRORING && oddity_ != "mirrored") {
      mirroring_ = *static_cast<const OniBool*>(data);
      return ONI_STATUS_OK;
    }
    return ONI_STATUS_NOT_SUPPORTED;
  }
  void notifyAllProperties() override {
    const OniCropping cropping{};
    raisePropertyChanged(ONI_STREAM_PROPERTY_CROPPING, &cropping, sizeof cropping);
  }

 private:
  void run() {
    for (int n = 0; running_; ++n) {
      OniFrame* frame = getServices().acquireFrame();
      if (frame == nullptr) continue;
      const int pixels = mode_.resolutionX * mode_.resolutionY;
      auto* depth = static_cast<std::uint16_t*>(frame->data);
      for (int p = 0; p < pixels; ++p) depth[p] = openNiTestDepth(n, p);
      frame->dataSize = 2 * pixels;
      frame->sensorType = ONI_SENSOR_DEPTH;
      frame->timestamp = 1000000 + 10000 * static_cast<std::uint64_t>(n);
      frame->frameIndex = n + 1;
      frame->width = mode_.resolutionX;
      frame->height = mode_.resolutionY;
      frame->videoMode = mode_;
      frame->croppingEnabled = FALSE;
      frame->cropOriginX = frame->cropOriginY = 0;
      frame->stride = 2 * mode_.resolutionX;
      raiseNewFrame(frame);
      getServices().releaseFrame(frame);
      std::this_thread::sleep_for(std::chrono::milliseconds(oddity_ == "slow" ? 300 : 10));
    }
  }

  std::string oddity_;
  OniVideoMode mode_{};
  OniBool mirroring_ = TRUE;
  std::atomic<bool> running_{false};
  std::thread thread_;
};

class Device : public DeviceBase {
 public:
  explicit Device(std::string oddity) : oddity_(std::move(oddity)) {
    const OniPixelFormat format = oddity_ == "tenths" ? ONI_PIXEL_FORMAT_DEPTH_100_UM : ONI_PIXEL_FORMAT_DEPTH_1_MM;
    modes_[0] = {format, 320, 240, 60};
    modes_[1] = {format, oddity_ == "small" ? 160 : 640, oddity_ == "small" ? 120 : 480, 30};
    modes_[2] = {format, 320, 240, 30};
    info_ = {ONI_SENSOR_DEPTH, 3, modes_};
  }
  OniStatus getSensorInfoList(OniSensorInfo** infos, int* count) override {
    *count = oddity_ == "no depth" ? 0 : 1;
    *infos = &info_;
    return ONI_STATUS_OK;
  }
  StreamBase* createStream(OniSensorType) override { return new Stream(oddity_); }
  void destroyStream(StreamBase* stream) override { delete stream; }

 private:
  std::string oddity_;
  OniVideoMode modes_[3] = {};
  OniSensorInfo info_{};
};

class Driver : public oni::driver::DriverBase {
 public:
  explicit Driver(OniDriverServices* services) : DriverBase(services) {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    (void)DriverBase::initialize(connected, disconnected, changed, cookie);
    look();
    running_ = true;
    thread_ = std::thread([this] {
      while (running_) {
        look();
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    });
    return ONI_STATUS_OK;
  }
  DeviceBase* deviceOpen(const char* uri, const char*) override {
    const std::string oddity = oddityOf(std::string(uri).substr(5));
    return oddity == "broken" ? nullptr : new Device(oddity);
  }
  void deviceClose(DeviceBase* device) override { delete device; }
  void shutdown() override {
    running_ = false;
    if (thread_.joinable()) thread_.join();
  }

 private:
  static std::string folder() {
    const char* name = std::getenv("LORICA_TEST_CAMERAS");
    return name == nullptr ? "/nowhere" : name;
  }
  static std::string oddityOf(const std::string& name) {
    std::ifstream file(folder() + "/" + name);
    std::string oddity;
    std::getline(file, oddity);
    return oddity;
  }
  void look() {
    std::map<std::string, OniDeviceInfo> now;
    std::error_code error;
    for (std::filesystem::directory_iterator file(folder(), error), end; !error && file != end; file.increment(error)) {
      const std::string name = file->path().filename().string();
      OniDeviceInfo info{};
      std::strncpy(info.uri, ("test/" + name).c_str(), ONI_MAX_STR - 1);
      std::strncpy(info.vendor, "Lorica", ONI_MAX_STR - 1);
      std::strncpy(info.name, "Test camera", ONI_MAX_STR - 1);
      info.usbVendorId = 0x1209;
      info.usbProductId = 1;
      now[name] = info;
    }
    for (auto seen = seen_.begin(); seen != seen_.end();) {
      if (now.count(seen->first) != 0) {
        ++seen;
        continue;
      }
      const OniDeviceInfo gone = seen->second;
      seen = seen_.erase(seen);
      deviceDisconnected(&gone);
    }
    for (const auto& [name, info] : now) {
      if (seen_.emplace(name, info).second) deviceConnected(&info);
    }
  }

  std::map<std::string, OniDeviceInfo> seen_;
  std::atomic<bool> running_{false};
  std::thread thread_;
};

}  // namespace

ONI_EXPORT_DRIVER(Driver)
