#include "apps/file_summary.h"
#include "capture/retarget/skeletal_retarget.h"
#include "capture/sensor/oni_file.h"
#include "capture/sensor/openni.h"
#include "capture/sensor/openni_usb.h"
#include "geometry/text.h"
#include "prepare/depth_motion.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {
namespace {

using Json = nlohmann::ordered_json;

void addJoints(const Motion& motion, FileSummary& summary) {
  std::size_t seen = 0, guessed = 0, unknown = 0;
  for (const SkeletonFrame& frame : motion.joints) {
    for (const TrackedJoint& joint : frame.joints) {
      ++(joint.confidence >= 1.0 ? seen : joint.confidence > 0.0 ? guessed : unknown);
    }
  }
  const double all = motion.joints.size() * kBodyJointCount;
  summary.report.line("user", std::to_string(motion.joints.front().user));
  summary.report.line("joints", fmt::format("{}: {} seen, {} guessed, {} unknown", kBodyJointCount, percent(seen / all),
                                            percent(guessed / all), percent(unknown / all)));
  summary.json["user"] = motion.joints.front().user;
  summary.json["jointsSeen"] = seen / all;
  summary.json["jointsGuessed"] = guessed / all;
  summary.json["jointsUnknown"] = unknown / all;
}

void addBones(const Skeleton& skeleton, FileSummary& summary) {
  const auto bones = std::count_if(skeleton.joints().begin(), skeleton.joints().end(),
                                   [](const Joint& joint) { return joint.bone.has_value(); });
  summary.report.line("joints", fmt::format("{}, {} of them humanoid bones", skeleton.jointCount(), bones));
  const Result<std::vector<HumanBone>> atRest = bonesLeftAtRest(skeleton);
  std::string retargeting = "any humanoid can perform it";
  if (!atRest) {
    retargeting = "only for characters with the same joints: " + atRest.error().message;
  } else if (!atRest->empty()) {
    std::vector<std::string_view> names;
    names.reserve(atRest->size());
    for (const HumanBone bone : *atRest) names.push_back(nameOf(bone));
    retargeting += fmt::format("; missing bones stay at rest: {}", fmt::join(names, ", "));
  }
  summary.report.line("retargeting", retargeting);
  summary.json["joints"] = skeleton.jointCount();
  summary.json["humanoidBones"] = bones;
  summary.json["retargetable"] = atRest.ok();
}

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

FileSummary describeMotion(const Motion& motion) {
  const double seconds = motion.seconds();
  const double rate = seconds > 0.0 ? (motion.frameCount() - 1) / seconds : 0.0;
  FileSummary summary{
      Report(fmt::format("{}: {}", motion.name, motion.bones ? "a motion of a skeleton" : "a recording of joints")),
      {}};
  summary.report.line("format", motion.format);
  if (!motion.firstGuess.empty()) summary.report.line("first guess", motion.firstGuess);
  summary.report.line("length", fmt::format("{:.2f} s", seconds));
  summary.report.line("frames", fmt::format("{} at {:.1f} per second", grouped(motion.frameCount()), rate));
  Json& json = summary.json;
  json["kind"] = motion.bones ? "motion" : "recording";
  json["name"] = motion.name;
  json["format"] = motion.format;
  json["seconds"] = seconds;
  json["frames"] = motion.frameCount();
  json["framesPerSecond"] = rate;
  if (motion.bones) {
    addBones(motion.bones->skeleton, summary);
  } else {
    addJoints(motion, summary);
  }
  for (const std::string& note : motion.notes) summary.report.note(note);
  json["firstGuess"] = motion.firstGuess;
  json["notes"] = motion.notes;
  return summary;
}

}  // namespace lorica
