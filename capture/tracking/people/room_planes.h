#pragma once

#include "capture/tracking/people/background.h"
#include "capture/tracking/people/depth_grid.h"
#include "geometry/math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Finds the floor in depth images and tracks it slowly.
///
/// The floor is the lowest level surface: a plane tilted by at most 40 degrees against the camera's up direction, and
/// by at most 20 degrees in roll, 0.3 to 2.5 m below the camera, with many level points on it and almost none below it.
/// A table is not mistaken for it, because something is visible below its edge. See docs/TRACKING.md.
class FloorFinder {
 public:
  explicit FloorFinder(const DepthGrid& grid);

  /// @param grid   same size in every call
  /// @param moves  the camera moves: the plane is followed fast
  void update(const DepthGrid& grid, bool moves);

  [[nodiscard]] bool found() const { return found_; }
  /// Unit, upwards; camera frame. The floor is the set of positions with up . position + height() = 0.
  [[nodiscard]] const Vec3& up() const { return plane_.up; }
  /// Of the camera over the floor [m].
  [[nodiscard]] double height() const { return plane_.height; }
  /// Defined as in Tracker.
  [[nodiscard]] Isometry3 floorFromCamera() const;

 private:
  struct Plane {
    Vec3 up = Vec3::UnitY();
    double height = 1.2;
  };
  struct Sample {
    Vec3f position;   ///< camera frame [m]
    float tolerance;  ///< of its height, for a camera 1 m up [m]
    bool level;       ///< its surface may be a floor
  };

  void takeSamples(const DepthGrid& grid);
  [[nodiscard]] bool sensible(const Plane& plane) const;
  /// Number of level points on the plane, minus a penalty for points below it.
  [[nodiscard]] double score(const Plane& plane) const;
  /// Least squares over the level points near the plane; whether they are numerous enough and extend far enough.
  [[nodiscard]] bool refine(Plane& plane) const;
  [[nodiscard]] bool detect(Plane& plane);

  std::vector<Sample> samples_;
  std::vector<std::uint32_t> level_;  ///< indices of the level samples
  Plane plane_;
  bool found_ = false;
  int frameCount_ = 0;
  int followed_ = 0;  ///< frames in which the plane was refined
  int doubts_ = 0;    ///< consecutive detections that another plane won
};

/// Finds the walls of the room: large planes with nothing behind them. Someone who stands close to a wall is separated
/// from it, whatever connects them in the image. See docs/TRACKING.md.
class WallFinder {
 public:
  explicit WallFinder(const DepthGrid& grid);

  /// Searches in the first frame and in every 15th.
  /// @param up     unit, upwards, camera frame: walls are within 30 degrees of it
  /// @param moves  the camera moves: no wall stays where it is
  void update(const DepthGrid& grid, const Vec3f& up, bool moves);
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
