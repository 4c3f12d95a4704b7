#include "apps/depth_inputs.h"

#include "apps/motions.h"
#include "apps/report.h"
#include "capture/sensor/nite.h"
#include "capture/sensor/openni.h"
#include "capture/virtual_sensor/virtual_script.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVirtualUri = "lorica://virtual";

/// Lorica's own driver, beside the program as in a build, or as installed; empty where it was not built.
fs::path virtualDriver() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const char* library : {"lib", "../lib", "../" LORICA_LIBDIR}) {
    const fs::path file = (program / library / "lorica/OpenNI2/Drivers/libLoricaSensor.so.0").lexically_normal();
    if (fs::exists(file, error)) return file;
  }
  return {};
}

/// What the virtual camera is told: --motion, its shipped recordings by their files, or else what the environment says.
Result<std::string> virtualText(const DepthOptions& options) {
  if (options.motion.empty()) return environment(kVirtualScriptVariable);
  std::string text = "motion=";
  std::stringstream names(options.motion);
  for (std::string name; std::getline(names, name, ',');) {
    if (text.back() != '=') text += ',';
    const fs::path shipped = isBareName(name) ? shippedRecording(name) : fs::path();
    const std::string motion = shipped.extension() == ".csv" ? shipped.string() : name;
    if (motion.find_first_of(" \t\n") != std::string::npos) {
      return Error{
          ErrorCode::kInvalidArgument,
          fmt::format("--motion: {}: found a blank, which the virtual camera takes for the end of the name", motion)};
    }
    text += motion;
  }
  return text;
}

/// The same, understood.
Result<VirtualScript> virtualScript(const DepthOptions& options, const std::string& text) {
  Result<VirtualScript> script = parseVirtualScript(text);
  if (!script) {
    const std::string origin = options.motion.empty() ? kVirtualScriptVariable : "--motion";
    return Error{script.error().code, origin + ": " + script.error().message};
  }
  return script;
}

/// OpenNI2 with the drivers that are asked for, told what the virtual camera shows.
Result<std::shared_ptr<OpenNi>> startOpenNi(const DepthOptions& options) {
  OpenNiSettings settings;
  if (!options.driver.empty()) settings.drivers.emplace_back(options.driver);
  if (options.virtualCamera) {
    const Result<std::string> text = virtualText(options);
    if (!text) return text.error();
    if (const Result<VirtualScript> script = virtualScript(options, *text); !script) return script.error();
    settings.drivers.push_back(virtualDriver());
    if (settings.drivers.back().empty()) {
      return Error{
          ErrorCode::kNotFound,
          "--virtual: Lorica's driver libLoricaSensor.so.0 is not beside the program nor in ../lib: it is built "
          "where libopenni2-dev is installed"};
    }
    // The driver reads it when OpenNI2 loads it, in this process.
    if (!options.motion.empty()) setenv(kVirtualScriptVariable, text->c_str(), 1);
  }
  return OpenNi::start(settings);
}

std::string uriOf(const DepthOptions& options) {
  return options.virtualCamera ? kVirtualUri : options.device;
}

Error withAdvice(const Error& error, const DepthOptions& options) {
  if (options.virtualCamera || error.code != ErrorCode::kNotFound) return error;
  return {error.code,
          error.message + "; `lorica info --devices` says what is seen and why, and --virtual needs no camera"};
}

}  // namespace

void addDepthOptions(CommandLine& app, DepthOptions& options) {
  Option* device = app.addOption("--device", options.device,
                                 "URI of the camera, as `lorica info --devices` names it [default: the first]")
                       ->typeName("URI");
  Option* driver =
      app.addOption("--driver", options.driver, "An OpenNI2 driver that the system lacks: lib*.so")->typeName("FILE");
  Option* virtualCamera =
      app.addFlag("--virtual", options.virtualCamera, "No camera: a virtual one before a virtual person");
  virtualCamera->excludes(device)->excludes(driver);
  app.addOption(
         "--motion", options.motion,
         "What the virtual person performs, over and over: a shipped recording, joints in .csv, or two of these, "
         "parted by a comma, for two people [default: as $LORICA_VIRTUAL says, else wave]")
      ->typeName("MOTION")
      ->needs(virtualCamera);
}

Result<std::unique_ptr<DepthSource>> openCamera(const DepthOptions& options) {
  const Result<std::shared_ptr<OpenNi>> openNi = startOpenNi(options);
  if (!openNi) return openNi.error();
  Result<std::unique_ptr<DepthSource>> camera = (*openNi)->open(uriOf(options));
  if (!camera) return withAdvice(camera.error(), options);
  return camera;
}

Result<std::unique_ptr<SkeletonSource>> openNite(const DepthOptions& options, const std::string& library) {
  const Result<std::shared_ptr<OpenNi>> openNi = startOpenNi(options);
  if (!openNi) return openNi.error();
  Result<std::unique_ptr<SkeletonSource>> joints = makeNiteSource(*openNi, library, uriOf(options));
  if (!joints) return withAdvice(joints.error(), options);
  return joints;
}

Result<std::unique_ptr<DepthSource>> openDepth(const DepthOptions& options) {
  if (!options.virtualCamera || !virtualDriver().empty()) return openCamera(options);
  const Result<std::string> text = virtualText(options);
  if (!text) return text.error();
  const Result<VirtualScript> script = virtualScript(options, *text);
  if (!script) return script.error();
  Result<VirtualSensor> sensor = makeVirtualSensor(*script);
  if (!sensor) return sensor.error();
  return std::unique_ptr<DepthSource>(std::make_unique<VirtualSensor>(std::move(*sensor)));
}

}  // namespace lorica
