#pragma once

#include "capture/sensor/depth_frame.h"
#include "geometry/result.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// A depth camera as its maker describes it, and the unit of its numbers. Undistorted pixels of depth along the axis.
struct DepthLens {
  int width = 0;         ///< pixels, 16 to 2048
  int height = 0;        ///< pixels
  double focalX = 0.0;   ///< [pixels]
  double focalY = 0.0;   ///< [pixels]
  double centreX = 0.0;  ///< of the axis, from the centre of the first pixel, as OpenCV and ROS count [pixels]
  double centreY = 0.0;
  std::array<double, 8> distortion{};  ///< k1 k2 p1 p2 k3 k4 k5 k6 of OpenCV: Brown-Conrady's and the rational model
  double metresPerUnit = 0.001;        ///< of the numbers in the images

  friend bool operator==(const DepthLens&, const DepthLens&) = default;

  /// A pinhole with the image's centre on its axis. @param horizontalFov,verticalFov  [rad]
  [[nodiscard]] static DepthLens pinhole(int width, int height, double horizontalFov, double verticalFov);
};

/// The usual camera of an image's size.
struct UsualLens {
  DepthLens lens;
  std::string_view camera;  ///< "Kinect v2"
};
/// @return nothing for a size that no known camera has
[[nodiscard]] std::optional<UsualLens> usualLens(int width, int height);

/// Reads a camera from a line: "640x576,fov=75x65,unit=mm", or with fx=, fy=, cx= and cy= in pixels. What is missing is
/// the usual camera's. A unit is mm, 0.1mm or a number of metres. Distortion is d=k1/k2/p1/p2/k3/k4/k5/k6.
/// @param width,height  of the images, if the text need not say them; else 0
[[nodiscard]] Result<DepthLens> parseDepthLens(std::string_view text, int width = 0, int height = 0);

/// Makes images of a DepthCamera, in millimetres, of a camera's own: by a table, which is made once. Each pixel has the
/// depth of the nearest of the camera's pixels on its ray. The field of view is that of the camera's middle row and
/// column, at most 130 degrees. What it costs: 4 bytes a pixel, 1 ms for a million pixels.
class DepthRectifier {
 public:
  /// @return or an error that says which number of the camera cannot be
  [[nodiscard]] static Result<DepthRectifier> create(const DepthLens& lens);

  [[nodiscard]] const DepthLens& lens() const { return lens_; }
  [[nodiscard]] const DepthCamera& camera() const { return camera_; }

  /// @param raw      lens().width x lens().height
  /// @param depthMm  overwritten completely, reusing its storage; depths beyond 65.535 m become 0
  void apply(std::span<const std::uint16_t> raw, std::vector<std::uint16_t>& depthMm) const;

 private:
  DepthLens lens_;
  DepthCamera camera_;
  std::vector<std::uint32_t> table_;  ///< the pixel of the camera for each; empty = the same
};

/// Whether numbers can be depths of people in a room: else the unit is another one. @return an error with what is found
/// @param raw  of an image; one with few measured pixels tells nothing
[[nodiscard]] Result<void> checkDepthUnit(const DepthLens& lens, std::span<const std::uint16_t> raw);

}  // namespace lorica
