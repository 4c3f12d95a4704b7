#pragma once

#include "capture/virtual_sensor/virtual_sensor.h"

#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// A virtual sensor described in one line of text, as the driver reads it from the environment variable LORICA_VIRTUAL.
///
/// Settings are `key=value`, separated by blanks, each at most once:
///
/// - `motion`: a shipped motion (kShippedMotions) or a joint CSV file that ends in .csv; two of them, separated
///   by a comma, for two people side by side [wave]
/// - `loop`: yes or no [yes]
/// - `pace`: live or fast [live]
/// - `noise`: nameOf(DepthNoiseKind); resolution and field of view are those of the modelled camera [kinect]
/// - `size`: full or half of its pixels along each side [full]
/// - `seed`: of the noise, from 0 [2026]
/// - `height`, `girth`: of the people, 0.5 to 2 [1]
/// - `start`: time in the motions at the sensor's time 0 [0 s]
/// - `distance`: of the camera from the people, 1 to 7 [3 m]
/// - `unplug`, `absent`: from:to, when the sensor is unplugged or the people are away [never, s]
struct VirtualScript {
  std::vector<std::string> motions = {"wave"};
  double height = 1.0;
  double girth = 1.0;
  bool halfSize = false;  ///< already applied to `settings.camera`
  double start = 0.0;     ///< time in the motions at the sensor's time 0 [s]
  std::vector<TimeSpan> absent;
  VirtualSensorSettings settings;  ///< live and looped, unless specified otherwise
};

/// The environment variable that the driver reads.
inline constexpr const char* kVirtualScriptVariable = "LORICA_VIRTUAL";

/// @return the script, or an error with the wrong part of the text and what was expected; files are not opened yet
[[nodiscard]] Result<VirtualScript> parseVirtualScript(std::string_view text);

/// Creates the sensor with room and people, using the mannequin.
/// @return the sensor, or an error if a motion cannot be loaded
[[nodiscard]] Result<VirtualSensor> makeVirtualSensor(const VirtualScript& script);

}  // namespace lorica
