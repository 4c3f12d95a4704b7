#include "capture/sensor/openni_usb.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>

namespace lorica {
namespace {

namespace fs = std::filesystem;

struct KnownCamera {
  std::uint16_t vendor;
  std::uint16_t product;  ///< 0: all products of the vendor
  std::string_view name;
  std::string_view driver;
  bool packaged;
};

constexpr std::string_view kPs1080 = "libPS1080 (included with OpenNI2)";
constexpr std::string_view kPsLink = "libPSLink (included with OpenNI2)";
constexpr std::string_view kFreenect = "libFreenectDriver of libfreenect";
constexpr std::string_view kFreenect2 = "libfreenect2-openni2 of libfreenect2";
constexpr std::string_view kOrbbec = "liborbbec of Orbbec's OpenNI2";

constexpr std::string_view kRealSense = "realsense.py";  // a program that sends, see docs/SENSORS.md
constexpr std::string_view kOrbbecSender = "orbbec.py";

constexpr std::array<KnownCamera, 26> kKnown = {{
    {0x1d27, 0x0600, "Asus Xtion", kPs1080, true},
    {0x1d27, 0x0601, "Asus Xtion Pro Live", kPs1080, true},
    {0x1d27, 0x0609, "PrimeSense Carmine or Structure Sensor", kPs1080, true},
    {0x1d27, 0x0500, "PrimeSense sensor", kPs1080, true},
    {0x1d27, 0x0401, "PrimeSense sensor", kPs1080, true},
    {0x1d27, 0x0400, "PrimeSense sensor", kPs1080, true},
    {0x1d27, 0x0300, "PrimeSense sensor", kPs1080, true},
    {0x1d27, 0x0200, "PrimeSense sensor", kPs1080, true},
    {0x1d27, 0, "newer PrimeSense sensor", kPsLink, true},
    {0x045e, 0x02ae, "Kinect v1", kFreenect, false},
    {0x045e, 0x02bf, "Kinect v1 for Windows", kFreenect, false},
    {0x045e, 0x02c4, "Kinect v2", kFreenect2, false},
    {0x045e, 0x02d8, "Kinect v2", kFreenect2, false},
    {0x045e, 0x02d9, "Kinect v2", kFreenect2, false},
    {0x045e, 0x097c, "Azure Kinect", "azure_kinect.py", false},
    {0x8086, 0x0ad3, "RealSense D415", kRealSense, false},
    {0x8086, 0x0b07, "RealSense D435", kRealSense, false},
    {0x8086, 0x0b3a, "RealSense D435i", kRealSense, false},
    {0x8086, 0x0b5b, "RealSense D405", kRealSense, false},
    {0x8086, 0x0b5c, "RealSense D455", kRealSense, false},
    {0x8086, 0x0b64, "RealSense L515", kRealSense, false},
    {0x03e7, 0x2485, "OAK camera", "oak.py", false},
    {0x03e7, 0xf63b, "OAK camera", "oak.py", false},
    {0x2bc5, 0x066b, "Femto Bolt", kOrbbecSender, false},
    {0x2bc5, 0x0669, "Femto Mega", kOrbbecSender, false},
    {0x2bc5, 0, "Orbbec camera", kOrbbec, false},
}};

const KnownCamera* find(std::uint16_t vendor, std::uint16_t product) {
  const auto* const found = std::find_if(kKnown.begin(), kKnown.end(), [&](const KnownCamera& k) {
    return k.vendor == vendor && (k.product == product || k.product == 0);
  });
  return found == kKnown.end() ? nullptr : found;
}

/// Parses the first line of a small system file.
std::optional<int> number(const fs::path& file, int base) {
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line) || line.empty() || line.size() > 8) return std::nullopt;
  int value = 0;
  for (const char c : line) {
    const int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : base;
    if (digit >= base) return std::nullopt;
    value = value * base + digit;
  }
  return value;
}

/// The kernel driver of one of the camera's interfaces, if it is one that blocks OpenNI2.
std::string kernelDriverOf(const fs::path& device) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(device, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.find(':') == std::string::npos) continue;  // "1-2:1.0" is an interface
    std::error_code none;
    const fs::path driver = fs::read_symlink(entry->path() / "driver", none);
    if (!none) names.push_back(driver.filename().string());
  }
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) {
    // Skip libusb's own access, and sound, which the camera's microphones use.
    if (name != "usbfs" && name != "snd-usb-audio" && name != "usbhid") return name;
  }
  return {};
}

}  // namespace

std::vector<UsbDepthCamera> usbDepthCameras(const fs::path& devices, const fs::path& nodes) {
  std::vector<fs::path> ports;
  std::error_code error;
  for (fs::directory_iterator entry(devices, error), end; !error && entry != end; entry.increment(error)) {
    ports.push_back(entry->path());
  }
  std::sort(ports.begin(), ports.end());
  std::vector<UsbDepthCamera> cameras;
  for (const fs::path& port : ports) {
    const std::optional<int> vendor = number(port / "idVendor", 16);
    const std::optional<int> product = number(port / "idProduct", 16);
    if (!vendor || !product) continue;  // an interface
    const KnownCamera* known = find(*vendor, *product);
    if (known == nullptr) continue;
    UsbDepthCamera camera;
    camera.vendor = *vendor;
    camera.product = *product;
    camera.name = known->name;
    camera.driver = known->driver;
    camera.packaged = known->packaged;
    camera.node = nodes / fmt::format("{:03}", number(port / "busnum", 10).value_or(0)) /
                  fmt::format("{:03}", number(port / "devnum", 10).value_or(0));
    camera.permitted = ::access(camera.node.c_str(), R_OK | W_OK) == 0;
    camera.kernelDriver = kernelDriverOf(port);
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

std::vector<std::string> whyNoCamera(const std::vector<UsbDepthCamera>& plugged, bool userDrivers) {
  if (plugged.empty()) return {"no known depth camera is plugged in"};
  std::vector<std::string> sentences;
  sentences.reserve(plugged.size());
  for (const UsbDepthCamera& camera : plugged) {
    const std::string which = fmt::format("{} ({:04x}:{:04x})", camera.name, camera.vendor, camera.product);
    if (camera.driver.ends_with(".py")) {
      sentences.push_back(
          fmt::format("{}: OpenNI2 has no driver for it: let {} send its depth to `lorica live --depth 7000`", which,
                      camera.driver));
    } else if (!camera.permitted) {
      sentences.push_back(
          fmt::format("{}: no permission for {}: install the udev rules of its driver (for OpenNI2: "
                      "package libopenni2-0) and plug it in again",
                      which, camera.node.string()));
    } else if (!camera.packaged && !userDrivers) {
      sentences.push_back(fmt::format("{}: needs {}: specify its file with --driver", which, camera.driver));
    } else if (!camera.kernelDriver.empty()) {
      sentences.push_back(
          fmt::format("{}: it is in use by the kernel driver {}: unload that module", which, camera.kernelDriver));
    } else {
      sentences.push_back(
          fmt::format("{}: {} did not open it: another program may be using it, or it needs more power "
                      "or another USB port",
                      which, camera.packaged ? camera.driver : "the specified driver"));
    }
  }
  return sentences;
}

}  // namespace lorica
