#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/sensor/openni.h"

#include <OniCAPI.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

/// libOpenNI2 loaded at run time. Internal: not installed, the only header that includes OpenNI2's headers.
namespace lorica {

/// Restores the working folder at the end of the block, however it is left: OpenNI2 changes it while it looks for
/// drivers, and NiTE 2 must be started in its own folder.
class WorkingFolder {
 public:
  WorkingFolder() : descriptor_(::open(".", O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {}
  ~WorkingFolder() {
    if (descriptor_ < 0) return;
    if (::fchdir(descriptor_) != 0) std::fprintf(stderr, "lorica: the working folder could not be restored\n");
    ::close(descriptor_);
  }
  WorkingFolder(const WorkingFolder&) = delete;
  WorkingFolder& operator=(const WorkingFolder&) = delete;

 private:
  int descriptor_;
};

/// Why the last dlopen() failed.
[[nodiscard]] std::string loaderProblem();

/// Sets a pointer to a function of a loaded library. @return whether the library has it
template <typename Function>
[[nodiscard]] bool loadSymbol(void* handle, const char* name, Function& function) {
  function = reinterpret_cast<Function>(::dlsym(handle, name));
  return function != nullptr;
}

/// The times of a camera's frames, which increase although the camera's own clock restarts when it is plugged in, and
/// although some drivers repeat a time.
class CameraClock {
 public:
  /// The next frame is of another clock than the last one.
  void restart() { isNew_ = true; }
  /// @param sensorTime  of a frame, in the camera's clock [s]
  [[nodiscard]] double timeOf(double sensorTime);
  /// The time of a moment without a frame; the clock restarts.
  [[nodiscard]] double timeWithout();

 private:
  /// Since the last time that was given [s].
  [[nodiscard]] double passed(std::chrono::steady_clock::time_point now) const;

  double last_ = -1.0;
  double offset_ = 0.0;
  bool isNew_ = false;
  std::chrono::steady_clock::time_point given_ = std::chrono::steady_clock::now();
};

/// The entry points in use.
struct OpenNiApi {
  decltype(&oniInitialize) initialize = nullptr;
  decltype(&oniShutdown) shutdown = nullptr;
  decltype(&oniGetExtendedError) extendedError = nullptr;
  decltype(&oniGetDeviceList) deviceList = nullptr;
  decltype(&oniReleaseDeviceList) releaseDeviceList = nullptr;
  decltype(&oniRegisterDeviceCallbacks) registerCallbacks = nullptr;
  decltype(&oniUnregisterDeviceCallbacks) unregisterCallbacks = nullptr;
  decltype(&oniDeviceOpen) deviceOpen = nullptr;
  decltype(&oniDeviceClose) deviceClose = nullptr;
  decltype(&oniDeviceGetSensorInfo) sensorInfo = nullptr;
  decltype(&oniDeviceCreateStream) createStream = nullptr;
  decltype(&oniStreamDestroy) streamDestroy = nullptr;
  decltype(&oniStreamStart) streamStart = nullptr;
  decltype(&oniStreamStop) streamStop = nullptr;
  decltype(&oniStreamReadFrame) readFrame = nullptr;
  decltype(&oniFrameRelease) frameRelease = nullptr;
  decltype(&oniWaitForAnyStream) wait = nullptr;
  decltype(&oniStreamSetProperty) setProperty = nullptr;
  decltype(&oniStreamGetProperty) getProperty = nullptr;
};

/// A running OpenNI2.
class OpenNiLibrary : public OpenNi, public std::enable_shared_from_this<OpenNiLibrary> {
 public:
  OpenNiLibrary(const OpenNiApi& api, std::vector<OpenNiDriver> drivers, OpenNiSettings settings);
  ~OpenNiLibrary() override;
  OpenNiLibrary(const OpenNiLibrary&) = delete;
  OpenNiLibrary& operator=(const OpenNiLibrary&) = delete;
  /// Calls oniInitialize.
  [[nodiscard]] Result<void> initialize();

  [[nodiscard]] Result<std::vector<OpenNiCamera>> cameras() const override;
  [[nodiscard]] const std::vector<OpenNiDriver>& drivers() const override { return drivers_; }
  [[nodiscard]] Result<std::unique_ptr<DepthSource>> open(const std::string& uri) override;

  [[nodiscard]] const OpenNiApi& api() const { return api_; }
  [[nodiscard]] const OpenNiSettings& settings() const { return settings_; }
  /// Whether the device was unplugged, or reported broken, and has not come back.
  [[nodiscard]] bool isGone(const std::string& uri) const;
  /// An error with OpenNI2's own description of the last failure.
  [[nodiscard]] Error failure(const std::string& what) const;

 private:
  void note(const OniDeviceInfo* device, bool gone);

  OpenNiApi api_;
  std::vector<OpenNiDriver> drivers_;
  OpenNiSettings settings_;
  OniCallbackHandle callbacks_ = nullptr;
  bool initialized_ = false;
  mutable std::mutex mutex_;  ///< never held while OpenNI2 is called: its threads call note()
  std::map<std::string, bool> gone_;
};

/// See OpenNi::open().
class OpenNiSource final : public DepthSource {
 public:
  [[nodiscard]] static Result<std::unique_ptr<OpenNiSource>> open(std::shared_ptr<OpenNiLibrary> library,
                                                                  const OpenNiCamera& camera);
  ~OpenNiSource() override { close(); }
  OpenNiSource(const OpenNiSource&) = delete;
  OpenNiSource& operator=(const OpenNiSource&) = delete;

  [[nodiscard]] const DepthCamera& camera() const override { return camera_; }
  [[nodiscard]] std::string name() const override;
  [[nodiscard]] Result<DepthRead> next(DepthFrame& frame) override;

  [[nodiscard]] OpenNiLibrary& library() { return *library_; }
  [[nodiscard]] OniDeviceHandle device() const { return device_; }
  /// Null while the camera is unplugged. A new handle each time the camera comes back.
  [[nodiscard]] OniStreamHandle stream() const { return stream_; }

 private:
  OpenNiSource(std::shared_ptr<OpenNiLibrary> library, OpenNiCamera which)
      : library_(std::move(library)), which_(std::move(which)) {}
  Result<void> open();
  void close();
  Result<DepthCamera> setUp();
  /// @return false while the camera is not there or not ready; an error if another kind of image returned
  Result<bool> comeBack();
  Result<void> copy(const OniFrame& from, DepthFrame& to);

  std::shared_ptr<OpenNiLibrary> library_;
  OpenNiCamera which_;
  DepthCamera camera_;
  bool tenths_ = false;   ///< the camera gives tenths of a millimetre
  bool mirrors_ = false;  ///< the camera cannot disable mirroring
  OniDeviceHandle device_ = nullptr;
  OniStreamHandle stream_ = nullptr;

  bool known_ = false;  ///< camera_ is final: callers rely on it
  CameraClock clock_;
};

}  // namespace lorica
