#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lorica {

/// A depth camera that is plugged in, whatever OpenNI2 makes of it.
struct UsbDepthCamera {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string name;            ///< "Kinect v1"
  std::string driver;          ///< what it needs, for people: "libPS1080, which OpenNI2 comes with"
  bool packaged = false;       ///< OpenNI2 comes with its driver
  std::filesystem::path node;  ///< "/dev/bus/usb/001/004"
  bool permitted = false;      ///< this user may read and write it
  std::string kernelDriver;    ///< what holds it in the kernel, such as "gspca_kinect"; empty: nothing does
};

/// The depth cameras on USB, in order of their ports.
/// @param devices  where the system lists USB devices
/// @param nodes    where it gives access to them
[[nodiscard]] std::vector<UsbDepthCamera> usbDepthCameras(const std::filesystem::path& devices = "/sys/bus/usb/devices",
                                                          const std::filesystem::path& nodes = "/dev/bus/usb");

/// Why OpenNI2 sees no camera, in one sentence for each one that is plugged in, or one that none is.
/// @param userDrivers  whether the user named a driver
[[nodiscard]] std::vector<std::string> whyNoCamera(const std::vector<UsbDepthCamera>& plugged, bool userDrivers);

}  // namespace lorica
