#pragma once

/// A depth camera of OpenNI2. Internal: not installed.

#include "capture/sensor/depth_source.h"
#include "capture/sensor/openni_library.h"

#include <chrono>
#include <memory>
#include <string>

namespace lorica {

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

  double lastTime_ = -1.0;
  double timeOffset_ = 0.0;  ///< the camera's clock restarts when it is plugged in
  bool known_ = false;       ///< camera_ is final: callers rely on it
  bool clockIsNew_ = false;
  std::chrono::steady_clock::time_point lastRead_;
};

}  // namespace lorica
