#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/skeleton_frame.h"
#include "viewer/renderer/image.h"

#include <array>
#include <cstdint>
#include <span>

namespace lorica::bench {

/// Joints drawn over a depth image.
struct DrawnSkeleton {
  std::array<Vec3, kBodyJointCount> joints;  ///< camera frame [m]
  std::array<bool, kBodyJointCount> sure{};  ///< others are drawn thin
  std::array<std::uint8_t, 3> colour{};      ///< red, green, blue; left limbs are drawn brighter
};

/// A tracked person in red.
[[nodiscard]] DrawnSkeleton trackedSkeleton(const SkeletonFrame& frame);
inline constexpr std::array<std::uint8_t, 3> kTrueColour = {60, 255, 60};

/// A depth image in grey with people's pixels tinted and skeletons over it, twice the size of the depth image.
/// @param labels  width x height: 0 nobody, 255 not measured, else a person
[[nodiscard]] Image depthOverlay(const DepthCamera& camera, std::span<const std::uint16_t> depthMm,
                                 std::span<const std::uint8_t> labels, std::span<const DrawnSkeleton> skeletons);

}  // namespace lorica::bench
