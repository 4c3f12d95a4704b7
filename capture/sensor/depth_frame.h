#pragma once

#include "geometry/math.h"
#include "geometry/result.h"

#include <cstdint>
#include <string>
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

/// Result of reading from a depth source.
enum class DepthRead : std::uint8_t {
  kFrame,      ///< a new frame was written
  kWaiting,    ///< no frame arrived within a tenth of a second
  kUnplugged,  ///< the sensor is unplugged; it may return, so try again
  kEnd,        ///< end of a recording
};

/// Source of depth frames: a sensor, a recording, the virtual sensor. To be read by one thread.
class DepthSource {
 public:
  virtual ~DepthSource() = default;

  /// The camera of all frames.
  [[nodiscard]] virtual const DepthCamera& camera() const = 0;
  /// Display name: "PrimeSense, PS1080 (1d27/0609@1/4)", "body.oni", "virtual sensor".
  [[nodiscard]] virtual std::string name() const = 0;

  /// Waits for the next frame, for a live source at most about a tenth of a second. Returns every frame once, in order.
  /// @param frame  written if the result is kFrame, reusing its storage; else unchanged
  /// @return the kind of result, or an error if the data is permanently unusable
  [[nodiscard]] virtual Result<DepthRead> next(DepthFrame& frame) = 0;
};

}  // namespace lorica
