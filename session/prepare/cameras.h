#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/skeleton_frame.h"
#include "geometry/result.h"

#include <memory>
#include <string>

namespace lorica {

/// The live depth source that the command line selects.
struct DepthOptions {
  std::string device;          ///< URI; empty = the first camera
  std::string driver;          ///< an additional OpenNI2 driver; empty = none
  bool virtualCamera = false;  ///< Lorica's driver, see docs/VIRTUAL_SENSOR.md
  std::string motion;          ///< motion of the virtual people; empty = as in $LORICA_VIRTUAL
  std::string stream;          ///< where another program sends images, see DepthStream; empty = none does
  std::string format;          ///< of images without headers, see parseBareDepth(); empty = they have headers

  /// Whether a certain camera was asked for.
  [[nodiscard]] bool asked() const { return virtualCamera || !device.empty() || !driver.empty() || !stream.empty(); }
};

/// Opens a real or virtual camera through OpenNI2.
/// @return the source, or an error that says why there is none and what to do
[[nodiscard]] Result<std::unique_ptr<DepthSource>> openCamera(const DepthOptions& options);

/// The skeletons that NiTE 2 tracks with such a camera, see makeNiteSource().
/// @param library  libNiTE2.so
[[nodiscard]] Result<std::unique_ptr<SkeletonSource>> openNite(const DepthOptions& options, const std::string& library);

/// Rejects an address or a format of a depth stream that cannot be, before any work.
[[nodiscard]] Result<void> checkDepth(const DepthOptions& options);

/// Like openCamera(), but a virtual camera does not need OpenNI2, and a stream is waited for.
[[nodiscard]] Result<std::unique_ptr<DepthSource>> openDepth(const DepthOptions& options);

}  // namespace lorica
