#pragma once

#include "geometry/math.h"

#include <cstdint>
#include <vector>

namespace lorica {

/// A depth camera as an undistorted pinhole with the image centre on its axis.
///
/// Camera frame: metres, right-handed, origin at the pinhole, +X to the right of the image, +Y up, +Z towards the
/// viewer: everything visible has z < 0. Images are not mirrored: the left hand of a person who faces the camera is on
/// the right side of the image. The top row comes first.
struct DepthCamera {
  int width = 640;                            ///< pixels
  int height = 480;                           ///< pixels
  double horizontalFov = 1.0144686707507438;  ///< [rad], of the PrimeSense sensor in Kinect v1 and Xtion
  double verticalFov = 0.78980943449644714;   ///< [rad]

  [[nodiscard]] double focalX() const;  ///< [pixels]
  [[nodiscard]] double focalY() const;  ///< [pixels]

  /// @param column,row  of the pixel; its centre is at + 0.5
  /// @param depth       along the axis, not along the ray [m]
  /// @return the position in the camera frame [m]
  [[nodiscard]] Vec3 positionOf(double column, double row, double depth) const;
  /// Where a position with z < 0 is seen, from the image's upper left corner; the first pixel's centre is (0.5, 0.5).
  [[nodiscard]] Eigen::Vector2d imagePointOf(const Vec3& position) const;

  friend bool operator==(const DepthCamera&, const DepthCamera&) = default;
};

/// One depth image.
struct DepthFrame {
  double time = 0.0;                   ///< in the sensor's clock [s], increases from frame to frame
  std::vector<std::uint16_t> depthMm;  ///< width x height, rows from the top; along the axis [mm]; 0 = not measured
};

}  // namespace lorica
