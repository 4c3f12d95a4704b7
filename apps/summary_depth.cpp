#include "apps/file_summary.h"
#include "capture/sensor/oni_file.h"
#include "capture/sensor/openni.h"
#include "capture/sensor/openni_usb.h"
#include "geometry/text.h"
#include "prepare/depth_motion.h"

#include <fmt/format.h>

namespace lorica {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 57.29577951308232;

std::string describe(const OpenNiCamera& camera) {
  std::string text = camera.vendor + " " + camera.name;
  if (camera.usbVendor != 0) text += fmt::format(" (USB {:04x}:{:04x})", camera.usbVendor, camera.usbProduct);
  if (!camera.driver.empty()) text += ", driver " + camera.driver;
  return text;
}

}  // namespace

Result<FileSummary> describeDepthRecording(const std::filesystem::path& file) {
  LORICA_TRY(const OniFile read, OniFile::open(file));
  const OniInfo& info = read.info();
  const double rate = info.duration > 0.0 ? (info.frameCount - 1) / info.duration : 0.0;
  FileSummary summary{Report(file.filename().string() + ": a depth recording"), {}};
  Report& report = summary.report;
  report.line("format", fmt::format("OpenNI {}{}", info.version,
                                    info.cutOff ? ", truncated: its complete frames are readable" : ""));
  if (!info.device.empty()) report.line("device", info.device);
  report.line("length", fmt::format("{:.2f} s", info.duration));
  report.line("depth frames", fmt::format("{} at {:.1f} per second", grouped(info.frameCount), rate));
  report.line("image", fmt::format("{} x {} pixels, {:.1f} x {:.1f} degrees{}", info.camera.width, info.camera.height,
                                   kDegrees * info.camera.horizontalFov, kDegrees * info.camera.verticalFov,
                                   info.mirrored ? "; stored mirrored, unmirrored when read" : ""));
  const Result<std::string> guess = firstGuessOfDepth(file);
  if (guess) report.line("first guess", *guess);
  if (info.colorFrameCount > 0) report.line("colour", counted(info.colorFrameCount, "frame") + ", ignored");
  if (info.infraredFrameCount > 0) report.line("infrared", counted(info.infraredFrameCount, "frame") + ", ignored");
  Json& json = summary.json;
  json["kind"] = "depth recording";
  json["name"] = file.filename().string();
  json["version"] = info.version;
  json["device"] = info.device;
  json["seconds"] = info.duration;
  json["frames"] = info.frameCount;
  json["framesPerSecond"] = rate;
  json["width"] = info.camera.width;
  json["height"] = info.camera.height;
  json["mirrored"] = info.mirrored;
  json["cutOff"] = info.cutOff;
  json["firstGuess"] = guess ? Json(*guess) : Json();
  return summary;
}

Result<FileSummary> describeDevices(const std::string& driver) {
  OpenNiSettings settings;
  if (!driver.empty()) settings.drivers.emplace_back(driver);
  LORICA_TRY(const std::shared_ptr<OpenNi> openNi, OpenNi::start(settings));
  LORICA_TRY(const std::vector<OpenNiCamera> cameras, openNi->cameras());

  FileSummary summary{Report(cameras.empty() ? "No depth camera found" : counted(std::ssize(cameras), "depth camera")),
                      {}};
  Json& json = summary.json;
  json["kind"] = "devices";
  json["cameras"] = Json::array();
  for (const OpenNiCamera& camera : cameras) {
    summary.report.line(camera.uri, describe(camera));
    json["cameras"].push_back({{"uri", camera.uri},
                               {"vendor", camera.vendor},
                               {"name", camera.name},
                               {"usb", fmt::format("{:04x}:{:04x}", camera.usbVendor, camera.usbProduct)},
                               {"driver", camera.driver}});
  }
  if (!cameras.empty()) summary.report.gap();
  json["drivers"] = Json::array();
  for (const OpenNiDriver& known : openNi->drivers()) {
    const std::string origin = known.packaged ? "part of OpenNI2" : "added";
    summary.report.line(known.file.filename().string(),
                        known.problem.empty() ? origin : origin + ", not usable: " + known.problem);
    json["drivers"].push_back({{"file", known.file.string()},
                               {"packaged", known.packaged},
                               {"problem", known.problem.empty() ? Json() : Json(known.problem)}});
  }
  json["why"] = Json::array();
  if (cameras.empty()) {
    for (const std::string& sentence : whyNoCamera(usbDepthCameras(), !driver.empty())) {
      summary.report.note(sentence);
      json["why"].push_back(sentence);
    }
    summary.report.note("Drivers for each camera: docs/SENSORS.md. Without a camera, try `lorica live --virtual`.");
  }
  return summary;
}

}  // namespace lorica
