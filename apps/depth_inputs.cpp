#include "apps/depth_inputs.h"

#include "apps/motions.h"
#include "sensor/virtual_sensor.h"
#include "skinning/mannequin.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

namespace lorica {
namespace {

Result<std::unique_ptr<DepthSource>> openVirtual(const std::string& name) {
  const Result<Motion> motion = readMotion(name);
  if (!motion) return motion.error();
  Result<VirtualPerformer> performer = motion->bones ? VirtualPerformer::create(makeMannequin(), *motion->bones)
                                                     : VirtualPerformer::create(makeMannequin(), motion->joints);
  if (!performer) return performer.error();
  std::vector<VirtualPerson> people;
  people.push_back({std::move(*performer)});
  VirtualSensorSettings settings;
  settings.live = true;
  settings.loop = true;
  Result<VirtualSensor> sensor = VirtualSensor::create(std::move(people), settings);
  if (!sensor) return sensor.error();
  return std::unique_ptr<DepthSource>(std::make_unique<VirtualSensor>(std::move(*sensor)));
}

}  // namespace

void addDepthOptions(CLI::App& app, DepthOptions& options) {
  CLI::Option* device = app.add_option("--device", options.device,
                                       "URI of the camera, as `lorica info --devices` names it [default: the first]")
                            ->type_name("URI");
  CLI::Option* driver =
      app.add_option("--driver", options.driver, "An OpenNI2 driver that the system lacks: lib*.so")->type_name("FILE");
  CLI::Option* virtualSensor =
      app.add_flag("--virtual", options.virtualSensor, "No camera: a virtual one before a virtual person");
  virtualSensor->excludes(device)->excludes(driver);
  app.add_option("--motion", options.motion, "What the virtual person performs, over and over [default: wave]")
      ->type_name("MOTION")
      ->needs(virtualSensor);
}

Result<std::unique_ptr<DepthSource>> openDepth(const DepthOptions& options) {
  if (options.virtualSensor) return openVirtual(options.motion);
  return Error{ErrorCode::kUnsupported, "no OpenNI2"};
}

}  // namespace lorica
