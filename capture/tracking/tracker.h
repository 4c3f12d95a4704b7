#pragma once

#include "capture/headset/worn_headset.h"
#include "capture/sensor/depth_frame.h"
#include "capture/skeleton_frame.h"
#include "geometry/result.h"

#include <memory>
#include <optional>
#include <span>

namespace lorica {

/// Who is looked for.
struct TrackerSettings {
  int maxPeople = 2;       ///< at once, 1 to 6; the nearest ones
  bool lowerBody = false;  ///< only waist, legs and feet are in the picture, and only they are looked for
};

/// A person as seen in one frame.
struct TrackedPerson {
  /// In the floor frame. Of the lower body alone arms and head are unknown, but the head of who wears a headset. `user`
  /// stays while the person is tracked; after that it is reused, counting from 1.
  SkeletonFrame skeleton;
  double height = 0.0;            ///< standing, current estimate [m]; 0 = not yet known
  double residual = 0.0;          ///< mean distance of the person's depth points from the fitted body [m]
  bool proportionsKnown = false;  ///< measured; before that they are an adult's
};

/// Finds people in depth images and tracks their 15 joints; no initial pose is required. See docs/TRACKING.md.
///
/// Floor frame: metres, right-handed, Y up, y = 0 on the floor, origin straight below the camera, the camera looks
/// along -Z (its axis, projected onto the floor). Until a floor is found, or if there is none, it is the camera frame
/// moved up by 1.2 m.
///
/// Use one instance per camera, because it keeps state. The same frames give the same joints. Does not allocate after
/// the first frames.
class Tracker {
 public:
  /// @return the tracker, or an error naming the camera or settings value that is out of range
  static Result<Tracker> create(const DepthCamera& camera, const TrackerSettings& settings = {});
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  /// @param frame  width x height of the camera; times increase
  /// @param worn   where a headset says that somebody's head is: it tells front from back, and where a head is that is
  ///               outside the image
  /// @return everyone who is tracked, by increasing user number; valid until the next call
  [[nodiscard]] std::span<const TrackedPerson> track(const DepthFrame& frame, const std::optional<WornHead>& worn = {});

  /// Where the camera is, in the floor frame: Y up, the floor at y = 0 [m].
  [[nodiscard]] const Isometry3& floorFromCamera() const;
  [[nodiscard]] bool floorFound() const;  ///< else the camera counts as level, and the floor is guessed
  /// Whether someone in the last frame is connected to the room, or is seen but not explained by the fitted body: the
  /// room is learned if they step out of the picture for a second.
  [[nodiscard]] bool roomUncertain() const;
  /// Of the last frame, width x height: 0 nobody, 255 not measured, else one number for each person's pixels. Computed
  /// when called; valid until the next call of track().
  [[nodiscard]] std::span<const std::uint8_t> labels();

 private:
  struct Impl;
  explicit Tracker(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica
