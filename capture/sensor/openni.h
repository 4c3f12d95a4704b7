#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/skeleton_frame.h"
#include "geometry/result.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// A depth camera found by OpenNI2.
struct OpenNiCamera {
  std::string uri;               ///< argument of open(): "1d27/0609@1/4"
  std::string vendor;            ///< "PrimeSense"
  std::string name;              ///< "PS1080"
  std::uint16_t usbVendor = 0;   ///< vendor's number; 0 = unknown
  std::uint16_t usbProduct = 0;  ///< product's number; 0 = unknown
  std::string driver;            ///< file name of the driver that provides it, as far as known
};

/// A driver file that is available to OpenNI2.
struct OpenNiDriver {
  std::filesystem::path file;  ///< the shared library
  bool packaged = false;       ///< stored beside libOpenNI2; else specified by the user
  std::string problem;         ///< why it cannot be used; empty if it can
};

/// Where OpenNI2 looks for cameras.
struct OpenNiSettings {
  /// Driver files in addition to those included with OpenNI2: for Kinects, or from a manufacturer.
  std::vector<std::filesystem::path> drivers;
  /// libOpenNI2.so.0; empty: located by the system.
  std::filesystem::path library;
};

/// OpenNI2, loaded on first use: Lorica also runs where it is not installed. Drivers are found in a private folder of
/// links, so nothing is written to the system. A process has only one OpenNI2, which all callers of start() share.
///
///     Result<std::shared_ptr<OpenNi>> openNi = OpenNi::start();
///     Result<std::unique_ptr<DepthSource>> source = (*openNi)->open();
///
/// start() restores the working folder, but changes it temporarily for all threads.
class OpenNi {
 public:
  /// @return OpenNI2, or an error: OpenNI2 is not installed, Lorica was built without it, a driver cannot be loaded, or
  /// OpenNI2 is already running with other drivers
  [[nodiscard]] static Result<std::shared_ptr<OpenNi>> start(const OpenNiSettings& settings = {});
  virtual ~OpenNi() = default;

  /// The cameras that are plugged in now, in OpenNI2's order.
  [[nodiscard]] virtual Result<std::vector<OpenNiCamera>> cameras() const = 0;
  /// All drivers; the user's drivers come last.
  [[nodiscard]] virtual const std::vector<OpenNiDriver>& drivers() const = 0;

  /// Opens a camera: 640 x 480 at 30 Hz in millimetres, not mirrored, or the nearest available mode. Sources keep
  /// OpenNI2 running. While its camera is unplugged, a source returns kUnplugged; it continues with the same camera,
  /// even at another USB port, with increasing times.
  /// @param uri  of a camera; empty: the first that provides depth
  [[nodiscard]] virtual Result<std::unique_ptr<DepthSource>> open(const std::string& uri = {}) = 0;
};

/// Skeletons from NiTE 2, for users who have it: closed middleware of PrimeSense that is no longer distributed.
/// Lorica's own tracker does not need it.
///
/// The first tracked person stays selected until NiTE 2 loses them; then the person with the lowest number follows.
/// While nobody is tracked, frames without known joints are returned; while the camera is unplugged, ten per second.
/// The floor comes from NiTE 2; until NiTE 2 knows it, it is assumed 8 cm below the lowest foot seen. As for all
/// sensors, a person who looks at the camera faces +Z.
///
/// @param openNi   provides the camera; NiTE 2 must use the same libOpenNI2
/// @param library  libNiTE2.so, with its data folder NiTE2 beside it
/// @param uri      of a camera; empty: the first one
/// @return a source that waits at most half a second for a camera frame; or an error
[[nodiscard]] Result<std::unique_ptr<SkeletonSource>> makeNiteSource(std::shared_ptr<OpenNi> openNi,
                                                                     const std::filesystem::path& library,
                                                                     const std::string& uri = {});

}  // namespace lorica
