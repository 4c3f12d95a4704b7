#pragma once

#include "capture/tracking/depth_grid.h"
#include "geometry/math.h"

#include <cstdint>
#include <vector>

namespace lorica {

/// Finds the floor in depth images and follows it slowly.
///
/// The floor is the lowest level surface: a plane within 40 degrees of the camera's own up and 20 of its roll, 0.3 to
/// 2.5 m under it, that many level points lie on and next to none lie under. A table is not taken for it: past its edge
/// something is seen below. See docs/TRACKING.md.
class FloorFinder {
 public:
  explicit FloorFinder(const DepthGrid& grid);

  /// @param grid  of the size of the first
  void update(const DepthGrid& grid);

  [[nodiscard]] bool found() const { return found_; }
  /// Unit, towards up; camera frame. The floor is where up . place + height() = 0.
  [[nodiscard]] const Vec3& up() const { return plane_.up; }
  /// Of the camera over the floor [m].
  [[nodiscard]] double height() const { return plane_.height; }
  /// As Tracker has it.
  [[nodiscard]] Isometry3 floorFromCamera() const;

 private:
  struct Plane {
    Vec3 up = Vec3::UnitY();
    double height = 1.2;
  };
  struct Sample {
    Vec3f place;      ///< camera frame [m]
    float tolerance;  ///< of its height, for a camera 1 m up [m]
    bool level;       ///< its surface may be a floor
  };

  void takeSamples(const DepthGrid& grid);
  [[nodiscard]] bool sensible(const Plane& plane) const;
  /// Level points on the plane, less those that tell against it.
  [[nodiscard]] double score(const Plane& plane) const;
  /// Least squares over the level points near the plane; whether there are enough, and spread enough.
  [[nodiscard]] bool refine(Plane& plane) const;
  [[nodiscard]] bool detect(Plane& plane);

  std::vector<Sample> samples_;
  std::vector<std::uint32_t> level_;  ///< which samples are
  Plane plane_;
  bool found_ = false;
  int frameCount_ = 0;
  int followed_ = 0;  ///< frames that the plane was refined in
  int doubts_ = 0;    ///< detections in a row that another plane won
};

}  // namespace lorica
