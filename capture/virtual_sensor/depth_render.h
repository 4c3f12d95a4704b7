#pragma once

#include "capture/sensor/depth_frame.h"
#include "geometry/tri_mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Which of its sides a surface shows.
enum class SurfaceSides : std::uint8_t {
  kOuter,  ///< closed: triangles seen from inside, clockwise, are not drawn
  kBoth,
};

/// Draws what an ideal depth camera sees: at each pixel the nearest surface on the ray through the pixel's centre.
///
/// Scan conversion of triangles into a buffer of inverse depth, which is affine over the image of a plane. Neighbouring
/// triangles leave no gap. What is nearer to the pinhole's plane than 5 cm is cut away. One thread; allocates nothing
/// after the first images. See docs/VIRTUAL_SENSOR.md.
///
///     DepthRenderer renderer{DepthCamera{}};
///     renderer.clear();
///     renderer.drawPlane(Vec3::UnitY(), -1.1, 0);                        // a floor 1.1 m below a level camera
///     renderer.draw(placesInCamera, mesh.triangles, SurfaceSides::kOuter, 1);  // person 1
class DepthRenderer {
 public:
  explicit DepthRenderer(const DepthCamera& camera);

  void clear();

  /// @param places     camera frame [m]; triangles with a place that is not finite are left out
  /// @param triangles  indices in range
  /// @param label      of the pixels that these triangles win
  void draw(std::span<const Vec3> places, std::span<const Triangle> triangles, SurfaceSides sides, std::uint8_t label);

  /// The whole plane normal . p = offset, seen from either side.
  /// @param normal  unit, camera frame
  /// @param offset  not 0 [m]
  void drawPlane(const Vec3& normal, double offset, std::uint8_t label);

  [[nodiscard]] const DepthCamera& camera() const { return camera_; }
  /// width x height, rows from above: 1 / depth along the axis [1/m]; 0 = nothing there.
  [[nodiscard]] std::span<const float> inverseDepth() const { return inverseDepth_; }
  /// width x height: of the surface seen; 0 = nothing there, or drawn with label 0.
  [[nodiscard]] std::span<const std::uint8_t> labels() const { return labels_; }

 private:
  /// A place as seen: column and row, pixel centres at + 0.5, and inverse depth.
  struct Seen {
    double column, row, inverse;
  };
  [[nodiscard]] Seen project(const Vec3& place) const;
  void drawClipped(const std::array<Vec3, 3>& corners, SurfaceSides sides, std::uint8_t label);
  void drawSeen(const Seen& a, const Seen& b, const Seen& c, SurfaceSides sides, std::uint8_t label);

  DepthCamera camera_;
  double focalX_, focalY_;
  std::vector<float> inverseDepth_;
  std::vector<std::uint8_t> labels_;
  std::vector<Seen> seen_;  ///< of the places being drawn; inverse = 0 where too near or not finite
};

}  // namespace lorica
