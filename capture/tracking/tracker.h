#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/skeleton_frame.h"
#include "geometry/result.h"

#include <memory>
#include <optional>
#include <span>

namespace lorica {

struct TrackerSettings {
  int maxPeople = 2;  ///< at once, 1 to 6; the nearest ones
};

/// A person as seen in one frame.
struct TrackedPerson {
  /// In the floor frame; `user` stays while the person is followed and is given anew, counting from 1, after that.
  SkeletonFrame skeleton;
  double height = 0.0;    ///< standing, as estimated so far [m]; 0 = not yet known
  double residual = 0.0;  ///< mean distance of the person's depth points from the fitted body [m]
  bool proportionsKnown = false;
};

/// Finds people in depth images and follows their 15 joints; no pose is demanded of them. See docs/TRACKING.md.
///
/// Floor frame: metres, right-handed, Y up, y = 0 on the floor, origin straight below the camera, the camera looks
/// along -Z (its axis, projected onto the floor). Until a floor was seen, and where there is none, it is the camera
/// frame moved up by 1.2 m.
///
/// One instance a camera: it remembers. The same frames give the same joints. After some frames nothing is allocated.
class Tracker {
 public:
  /// @return the tracker, or which of camera and settings is out of range
  static Result<Tracker> create(const DepthCamera& camera, const TrackerSettings& settings = {});
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  /// @param frame  width x height of the camera; times rise
  /// @return everyone who is followed, by rising user number; valid until the next call
  [[nodiscard]] std::span<const TrackedPerson> track(const DepthFrame& frame);

  [[nodiscard]] const Isometry3& floorFromCamera() const;
  [[nodiscard]] bool floorFound() const;

 private:
  struct Impl;
  explicit Tracker(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica
