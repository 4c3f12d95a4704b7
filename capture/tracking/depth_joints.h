#pragma once

#include "capture/sensor/depth_source.h"
#include "capture/skeleton_frame.h"
#include "capture/tracking/tracker.h"

#include <chrono>
#include <memory>
#include <optional>

namespace lorica {

/// What a depth source showed when joints were last asked of it, and what came of it.
struct DepthSight {
  DepthRead read = DepthRead::kWaiting;
  int people = 0;                                 ///< followed in the frame
  bool followed = false;                          ///< whether the joints are a person's; else all are unknown
  double trackSeconds = 0.0;                      ///< what the tracker took [s]
  std::chrono::steady_clock::time_point arrived;  ///< when the frame was had, before it was tracked
  DepthFrame image;                               ///< the last one that was had; empty before the first
  SkeletonFrame joints;                           ///< what was given, world frame
  Isometry3 cameraFromWorld = Isometry3::Identity();
};

/// The joints of one person before a depth camera.
///
/// World frame: the tracker's floor frame, moved over the floor so that the person first stood at its origin. Where
/// nobody is seen, and about ten times a second while a live source is silent or unplugged, a frame of unknown joints
/// comes, so that whatever follows them eases to rest. Times rise and begin with the source's own; a sensor whose clock
/// starts anew goes on where it left off.
class DepthJoints final : public SkeletonSource {
 public:
  /// @param person  the user number to follow, see TrackedPerson; 0 = the nearest, for as long as that one is followed
  DepthJoints(std::unique_ptr<DepthSource> depth, Tracker tracker, int person = 0);

  [[nodiscard]] Result<std::optional<SkeletonFrame>> next() override;

  [[nodiscard]] const DepthSource& source() const { return *depth_; }
  /// Of the last next().
  [[nodiscard]] const DepthSight& sight() const { return sight_; }

 private:
  [[nodiscard]] const TrackedPerson* choose(std::span<const TrackedPerson> people) const;
  [[nodiscard]] double riseTo(double sensorTime);

  std::unique_ptr<DepthSource> depth_;
  Tracker tracker_;
  int wanted_;
  int following_ = 0;  ///< user number; 0 = nobody
  DepthSight sight_;
  std::optional<double> time_;        ///< of the last frame given [s]
  double worldFromSensorTime_ = 0.0;  ///< [s]
  std::optional<Vec3> stage_;         ///< of the world's origin in the floor frame
};

}  // namespace lorica
