#pragma once

#include "capture/sensor/depth_frame.h"
#include "geometry/tri_mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Visible sides of a surface.
enum class SurfaceSides : std::uint8_t {
  kOuter,  ///< closed surface: triangles seen from inside, clockwise, are not drawn
  kBoth,
};

/// Renders the image of an ideal depth camera: at each pixel the nearest surface on the ray through the pixel centre.
///
/// Scan conversion of triangles into an inverse depth buffer; inverse depth of a plane is affine in image coordinates.
/// Adjacent triangles leave no gap. Geometry nearer than 5 cm to the pinhole's plane is clipped. Single-threaded;
/// allocates nothing after the first images. See docs/VIRTUAL_SENSOR.md.
///
///     DepthRenderer renderer{DepthCamera{}};
///     renderer.clear();
///     renderer.drawPlane(Vec3::UnitY(), -1.1, 0);                        // a floor 1.1 m below a level camera
///     renderer.draw(positionsInCamera, mesh.triangles, SurfaceSides::kOuter, 1);  // person 1
class DepthRenderer {
 public:
  explicit DepthRenderer(const DepthCamera& camera);

  void clear();

  /// @param positions  camera frame [m]; triangles with a non-finite position are skipped
  /// @param triangles  indices in range
  /// @param label      label of the pixels in which these triangles are visible
  void draw(std::span<const Vec3> positions, std::span<const Triangle> triangles, SurfaceSides sides,
            std::uint8_t label);

  /// The infinite plane normal . p = offset, visible from both sides.
  /// @param normal  unit, camera frame
  /// @param offset  not 0 [m]
  void drawPlane(const Vec3& normal, double offset, std::uint8_t label);

  [[nodiscard]] const DepthCamera& camera() const { return camera_; }
  /// width x height, rows from the top: 1 / depth along the axis [1/m]; 0 = no surface.
  [[nodiscard]] std::span<const float> inverseDepth() const { return inverseDepth_; }
  /// width x height: label of the visible surface; 0 = no surface, or drawn with label 0.
  [[nodiscard]] std::span<const std::uint8_t> labels() const { return labels_; }

 private:
  /// A projected point: column and row, pixel centres at + 0.5, and inverse depth.
  struct Seen {
    double column, row, inverse;
  };
  [[nodiscard]] Seen project(const Vec3& position) const;
  void drawClipped(const std::array<Vec3, 3>& corners, SurfaceSides sides, std::uint8_t label);
  void drawSeen(const Seen& a, const Seen& b, const Seen& c, SurfaceSides sides, std::uint8_t label);

  DepthCamera camera_;
  double focalX_, focalY_;
  std::vector<float> inverseDepth_;
  std::vector<std::uint8_t> labels_;
  std::vector<Seen> seen_;  ///< projection of the current positions; inverse = 0 if too near or not finite
};

}  // namespace lorica
