#pragma once

#include "capture/virtual_sensor/depth_noise.h"

#include <array>
#include <string_view>

namespace lorica {

/// Errors of cameras that the virtual sensor does not offer. The tracker is judged with them, and learns from them.
[[nodiscard]] DepthNoiseSettings realSenseNoise();     ///< filtered stereo, RealSense D400: set from a recording
[[nodiscard]] DepthNoiseSettings timeOfFlightNoise();  ///< Kinect v2: published figures

/// Of all cameras.
inline constexpr std::array<std::string_view, 5> kCameraNames = {"kinect", "realsense", "tof", "mild", "none"};
/// @param name  one of kCameraNames
[[nodiscard]] DepthNoiseSettings noiseNamed(std::string_view name);

}  // namespace lorica
