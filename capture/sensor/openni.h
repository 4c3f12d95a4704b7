#pragma once

#include "capture/sensor/depth_source.h"
#include "geometry/result.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace lorica {

/// A depth camera that OpenNI2 has found.
struct OpenNiCamera {
  std::string uri;     ///< what open() takes: "1d27/0609@1/4"
  std::string vendor;  ///< "PrimeSense"
  std::string name;    ///< "PS1080"
  std::uint16_t usbVendor = 0;
  std::uint16_t usbProduct = 0;
  std::string driver;  ///< file name of the driver that gives it, as far as can be told
};

/// A driver file that OpenNI2 was given.
struct OpenNiDriver {
  std::filesystem::path file;
  bool packaged = false;  ///< lies beside libOpenNI2, else the user named it
  std::string problem;    ///< why it cannot be used; empty where it can
};

struct OpenNiSettings {
  /// Driver files beside those that OpenNI2 comes with: for Kinects, or a maker's own.
  std::vector<std::filesystem::path> drivers;
  /// libOpenNI2.so.0; empty: as the system finds it.
  std::filesystem::path library;
};

/// OpenNI2, loaded when it is first asked for: Lorica runs where it is not installed. Drivers are found in a private
/// folder of links, so that nothing is written into the system. OpenNI2 exists once a process: those who start it share
/// it.
///
///     Result<std::shared_ptr<OpenNi>> openNi = OpenNi::start();
///     Result<std::unique_ptr<DepthSource>> source = (*openNi)->open();
///
/// Starting leaves the working folder as it was, but for a moment it is another one for all threads.
class OpenNi {
 public:
  /// @return or why not: OpenNI2 is not installed, Lorica was built without it, a driver cannot be loaded, or OpenNI2
  ///         runs with other drivers already
  [[nodiscard]] static Result<std::shared_ptr<OpenNi>> start(const OpenNiSettings& settings = {});
  virtual ~OpenNi() = default;

  /// The cameras that are plugged in now, in OpenNI2's order.
  [[nodiscard]] virtual Result<std::vector<OpenNiCamera>> cameras() const = 0;
  /// All drivers, those of the user last.
  [[nodiscard]] virtual const std::vector<OpenNiDriver>& drivers() const = 0;

  /// Opens a camera: 640 x 480 at 30 Hz in millimetres, not mirrored, or what comes nearest to it. Sources keep OpenNI2
  /// running. While its camera is unplugged a source says kUnplugged; it goes on with the same camera, even in another
  /// socket, and its times go on rising.
  /// @param uri  of a camera; empty: the first that gives depth
  [[nodiscard]] virtual Result<std::unique_ptr<DepthSource>> open(const std::string& uri = {}) = 0;
};

/// Records what a camera gives, by OpenNI2's own recorder, into an .oni file. One at a time in a process.
class OpenNiRecorder {
 public:
  /// Begins a file beside `file`, named x.part.oni. It can be played even when this program is killed. Images that the
  /// camera gives from now on are recorded, whether they are read or not.
  /// @param source  one of OpenNi::open(); it must outlive the recorder, and someone must read it
  [[nodiscard]] static Result<std::unique_ptr<OpenNiRecorder>> start(DepthSource& source,
                                                                     const std::filesystem::path& file);
  /// Abandons the recording, if it was not finished, and keeps the file beside.
  virtual ~OpenNiRecorder() = default;

  /// Ends the recording, checks it, and gives it its name.
  /// @return number of frames, or what is wrong with them
  [[nodiscard]] virtual Result<int> finish() = 0;
};

}  // namespace lorica
