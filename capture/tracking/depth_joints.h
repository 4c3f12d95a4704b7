#pragma once

#include "capture/headset/worn_headset.h"
#include "capture/sensor/depth_source.h"
#include "capture/skeleton_frame.h"
#include "capture/tracking/people_places.h"
#include "capture/tracking/tracker.h"

#include <chrono>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace lorica {

/// What the depth source showed at the last request for joints, and the result.
struct DepthSight {
  DepthRead read = DepthRead::kWaiting;
  int people = 0;                                 ///< tracked in the frame
  bool followed = false;                          ///< whether the joints are a person's; otherwise all are unknown
  bool roomUncertain = false;                     ///< see Tracker::roomUncertain()
  bool floorFound = false;                        ///< see Tracker::floorFound()
  double trackSeconds = 0.0;                      ///< time spent in the tracker [s]
  std::chrono::steady_clock::time_point arrived;  ///< when the frame was received, before tracking
  DepthFrame image;                               ///< the last one received; empty before the first
  SkeletonFrame joints;                           ///< as returned, world frame
  std::vector<SkeletonFrame> places;              ///< of several people, world frame; empty if one is followed
  Vec3 stage = Vec3::Zero();                      ///< the world's origin in the floor frame [m]
  std::optional<WornHead> worn;                   ///< of the image, floor frame
  Isometry3 cameraFromWorld = Isometry3::Identity();
};

/// The joints of one person in front of a depth camera, or of several at places, see PeoplePlaces.
///
/// World frame: the tracker's floor frame, moved along the floor such that the person's first position is its origin.
/// If nobody is seen, and about ten times a second while a live source is silent or unplugged, a frame of unknown
/// joints is returned, so that anything driven by them eases to rest. Times increase and start with the source's own;
/// if the sensor's clock restarts, time continues where it left off.
class DepthJoints final : public SkeletonSource {
 public:
  /// @param person  the user number to follow, see TrackedPerson; 0 = the nearest person, for as long as they are
  /// tracked
  DepthJoints(std::unique_ptr<DepthSource> depth, Tracker tracker, int person = 0);
  /// Follows several people: next() gives those of the first place, DepthSight::places those of all.
  DepthJoints(std::unique_ptr<DepthSource> depth, Tracker tracker, PeoplePlaces places);

  [[nodiscard]] Result<std::optional<SkeletonFrame>> next() override;

  /// Whose headset is worn by somebody before the camera. To be called before the first next().
  void wear(std::shared_ptr<const WornHeadset> headset) { headset_ = std::move(headset); }

  [[nodiscard]] const DepthSource& source() const { return *depth_; }
  /// Of the last next().
  [[nodiscard]] const DepthSight& sight() const { return sight_; }

 private:
  [[nodiscard]] const TrackedPerson* choose(std::span<const TrackedPerson> people) const;
  [[nodiscard]] double riseTo(double sensorTime);
  void follow(std::span<const TrackedPerson> people);
  void fillPlaces(std::span<const TrackedPerson> people);

  std::unique_ptr<DepthSource> depth_;
  Tracker tracker_;
  int wanted_;
  std::optional<PeoplePlaces> places_;
  std::shared_ptr<const WornHeadset> headset_;  ///< null = none
  int following_ = 0;                           ///< user number; 0 = nobody
  DepthSight sight_;
  std::optional<double> time_;        ///< of the last returned frame [s]
  double worldFromSensorTime_ = 0.0;  ///< [s]
  std::optional<Vec3> stage_;         ///< the world's origin in the floor frame
};

}  // namespace lorica
