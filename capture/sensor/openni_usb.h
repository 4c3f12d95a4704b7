#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lorica {

/// A depth camera that is plugged in, whether or not OpenNI2 recognises it.
struct UsbDepthCamera {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string name;       ///< "Kinect v1"
  std::string driver;     ///< required driver, for display: "libPS1080 (included with OpenNI2)"; or a sender: "oak.py"
  bool packaged = false;  ///< OpenNI2 includes its driver
  std::filesystem::path node;  ///< "/dev/bus/usb/001/004"
  bool permitted = false;      ///< the current user may read and write it
  std::string kernelDriver;    ///< kernel driver that occupies it, for example "gspca_kinect"; empty: none
};

/// The depth cameras on USB, in the order of their ports.
/// @param devices  folder in which the system lists USB devices
/// @param nodes    folder in which it provides access to them
[[nodiscard]] std::vector<UsbDepthCamera> usbDepthCameras(const std::filesystem::path& devices = "/sys/bus/usb/devices",
                                                          const std::filesystem::path& nodes = "/dev/bus/usb");

/// Explains why OpenNI2 sees no camera: one sentence for each camera that is plugged in, or one sentence if there is
/// none.
/// @param userDrivers  whether the user specified a driver
[[nodiscard]] std::vector<std::string> whyNoCamera(const std::vector<UsbDepthCamera>& plugged, bool userDrivers);

}  // namespace lorica
