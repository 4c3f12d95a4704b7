#include "tests/bench/generators/other_cameras.h"

namespace lorica {

DepthNoiseSettings realSenseNoise() {
  DepthNoiseSettings settings;
  settings.sensor.horizontalFov = 0.9566291926;  // focal length 617.25 pixels
  settings.sensor.verticalFov = 0.7412824526;
  settings.axialNoise = {.base = 0.0005, .quadratic = 0.0074, .nearest = 0.9, .angle = 0.0, .angleFar = 0.0};
  settings.lasting = 0.3;
  settings.shared = 0.64;
  settings.smoothness = 20.0;
  settings.lateral = 0.5;
  settings.smear = 12.0;
  settings.baseline = settings.edgeLoss = settings.steps = 0.0;
  settings.dropout = 0.0005;
  settings.grazing = false;
  settings.min = 0.3;
  return settings;
}

DepthNoiseSettings timeOfFlightNoise() {
  DepthNoiseSettings settings;
  settings.sensor = {512, 424, 1.2223, 1.0514};  // focal length 365.5 pixels
  settings.axialNoise = {.base = 0.0012917, .quadratic = 0.0003, .nearest = 0.83333, .angle = 0.0, .angleFar = 0.0001};
  settings.lasting = settings.shared = 0.0;
  settings.lateral = 0.25;
  settings.smear = 2.0;
  settings.baseline = settings.edgeLoss = settings.steps = 0.0;
  settings.dropout = 0.001;
  settings.max = 4.5;
  return settings;
}

DepthNoiseSettings noiseNamed(std::string_view name) {
  if (name == "realsense") return realSenseNoise();
  if (name == "tof") return timeOfFlightNoise();
  return DepthNoiseSettings::of(depthNoiseNamed(name).value());
}

}  // namespace lorica
