#pragma once

#include "capture/sensor/openni.h"
#include "capture/sensor/openni_stage.h"

#include <OniCAPI.h>

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

/// libOpenNI2 loaded at run time. Internal: not installed, the only header that includes OpenNI2's headers.
/// Internal: not installed.

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
  decltype(&oniCreateRecorder) createRecorder = nullptr;
  decltype(&oniRecorderAttachStream) recorderAttach = nullptr;
  decltype(&oniRecorderStart) recorderStart = nullptr;
  decltype(&oniRecorderStop) recorderStop = nullptr;
  decltype(&oniRecorderDestroy) recorderDestroy = nullptr;
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

}  // namespace lorica
