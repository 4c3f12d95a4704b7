#include "session/prepare/cameras.h"

#include "capture/sensor/openni.h"
#include "capture/streams/depth_stream.h"
#include "capture/virtual_sensor/virtual_script.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "session/prepare/read_motion.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVirtualUri = "lorica://virtual";

/// Lorica's driver, in the build tree or installed; empty if it was not built.
fs::path virtualDriver() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const char* library : {"lib", "../lib", "../" LORICA_LIBDIR}) {
    const fs::path file = (program / library / "lorica/OpenNI2/Drivers/libLoricaSensor.so.0").lexically_normal();
    if (fs::exists(file, error)) return file;
  }
  return {};
}

/// The script of the virtual camera: --motion with shipped names replaced by their files, or the environment variable.
Result<std::string> virtualText(const DepthOptions& options) {
  if (options.motion.empty()) return environment(kVirtualScriptVariable);
  std::string text = "motion=";
  std::stringstream names(options.motion);
  for (std::string name; std::getline(names, name, ',');) {
    if (text.back() != '=') text += ',';
    const fs::path shipped = isBareName(name) ? shippedRecording(name) : fs::path();
    const std::string motion = shipped.extension() == ".csv" ? shipped.string() : name;
    if (motion.find_first_of(" \t\n") != std::string::npos) {
      return invalidArgument("--motion: {}: found white space, which ends a name in the script of the virtual camera",
                             motion);
    }
    text += motion;
  }
  return text;
}

/// The parsed script.
Result<VirtualScript> virtualScript(const DepthOptions& options, const std::string& text) {
  return prefixed(options.motion.empty() ? kVirtualScriptVariable : "--motion", parseVirtualScript(text));
}

/// Starts OpenNI2 with the requested drivers, and passes the script to the virtual camera.
Result<std::shared_ptr<OpenNi>> startOpenNi(const DepthOptions& options) {
  OpenNiSettings settings;
  if (!options.driver.empty()) settings.drivers.emplace_back(options.driver);
  if (options.virtualCamera) {
    LORICA_TRY(const std::string text, virtualText(options));
    LORICA_TRY_DO(virtualScript(options, text));
    settings.drivers.push_back(virtualDriver());
    if (settings.drivers.back().empty()) {
      return notFound(
          "--virtual: Lorica's driver libLoricaSensor.so.0 was not found next to the program or in ../lib; it is built "
          "only if libopenni2-dev is installed");
    }
    // OpenNI2 loads the driver into this process, which then reads the variable.
    if (!options.motion.empty()) setenv(kVirtualScriptVariable, text.c_str(), 1);
  }
  return OpenNi::start(settings);
}

Result<DepthStreamSettings> streamOf(const DepthOptions& options) {
  DepthStreamSettings settings;
  settings.at = options.stream;
  if (!options.format.empty()) {
    LORICA_TRY(settings.bare, prefixed("--depth-format", parseBareDepth(options.format)));
  }
  return settings;
}

std::string uriOf(const DepthOptions& options) {
  return options.virtualCamera ? kVirtualUri : options.device;
}

Error withAdvice(const Error& error, const DepthOptions& options) {
  if (options.virtualCamera || error.code != ErrorCode::kNotFound) return error;
  return {error.code, error.message + "; `lorica info --devices` lists cameras and drivers; --virtual needs no camera"};
}

}  // namespace

Result<std::unique_ptr<SkeletonSource>> openNite(const DepthOptions& options, const std::string& library) {
  LORICA_TRY(const std::shared_ptr<OpenNi> openNi, startOpenNi(options));
  Result<std::unique_ptr<SkeletonSource>> joints = makeNiteSource(openNi, library, uriOf(options));
  if (!joints) return withAdvice(joints.error(), options);
  return joints;
}

Result<void> checkDepth(const DepthOptions& options) {
  LORICA_TRY(const DepthStreamSettings settings, streamOf(options));
  return options.stream.empty() ? Result<void>() : prefixed("--depth", DepthStream::check(settings));
}

std::string tellWaiting(const DepthOptions& options, Host& host) {
  if (options.stream.empty()) return "Opening the camera";
  host.tell(fmt::format("Waiting for depth images from {}; press Ctrl-C to stop.", depthStreamName(options.stream)));
  return "Waiting for depth images";
}

Result<std::unique_ptr<DepthSource>> openDepth(const DepthOptions& options) {
  if (!options.stream.empty()) {
    LORICA_TRY(const DepthStreamSettings settings, streamOf(options));
    LORICA_TRY(std::unique_ptr<DepthStream> stream, prefixed("--depth", DepthStream::open(settings)));
    return std::unique_ptr<DepthSource>(std::move(stream));
  }
  if (!options.virtualCamera || !virtualDriver().empty()) {
    LORICA_TRY(const std::shared_ptr<OpenNi> openNi, startOpenNi(options));
    Result<std::unique_ptr<DepthSource>> camera = openNi->open(uriOf(options));
    if (!camera) return withAdvice(camera.error(), options);
    return camera;
  }
  LORICA_TRY(const std::string text, virtualText(options));
  LORICA_TRY(const VirtualScript script, virtualScript(options, text));
  LORICA_TRY(VirtualSensor sensor, makeVirtualSensor(script));
  return std::unique_ptr<DepthSource>(std::make_unique<VirtualSensor>(std::move(sensor)));
}

}  // namespace lorica
