#pragma once

#include "capture/tracking/people/background.h"
#include "capture/tracking/people/depth_grid.h"
#include "geometry/math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Finds the walls of the room: large planes with nothing behind them. Someone who stands close to a wall is separated
/// from it, whatever connects them in the image. See docs/TRACKING.md.
class WallFinder {
 public:
  explicit WallFinder(const DepthGrid& grid);

  /// Searches in the first frame and in every 15th.
  /// @param up  unit, upwards, camera frame: walls are within 30 degrees of it
  void update(const DepthGrid& grid, const Vec3f& up);
  /// Sets the kinds of the walls' cells to kWall.
  void mark(const DepthGrid& grid, std::span<CellKind> kinds) const;

 private:
  /// normal . position + offset = 0; the normal points to the camera; camera frame.
  struct Plane {
    Vec3f normal = Vec3f::Zero();
    float offset = 0.0F;
    [[nodiscard]] float distance(const Vec3f& position) const { return normal.dot(position) + offset; }
  };
  struct Sample {
    Vec3f position = Vec3f::Zero();  ///< camera frame [m]
    Vec3f normal = Vec3f::Zero();    ///< unit; zero where the surface is not smooth
    float tolerance = 0.0F;          ///< [m]
    bool taken = false;              ///< on a wall found before
  };
  void takeSamples(const DepthGrid& grid);
  [[nodiscard]] static bool isOn(const Plane& plane, const Sample& sample);
  [[nodiscard]] double score(const Plane& plane) const;
  [[nodiscard]] bool refine(Plane& plane) const;
  [[nodiscard]] bool detect(const Vec3f& up, Plane& plane);

  std::vector<Sample> samples_;
  std::vector<std::uint32_t> smooth_;  ///< samples with a normal that are not taken
  std::vector<Plane> planes_;
  DepthTable tolerance_;  ///< [m]
  int frameCount_ = 0;
};

}  // namespace lorica
