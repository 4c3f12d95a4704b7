#pragma once

#include "capture/headset/worn_headset.h"
#include "capture/sensor/depth_frame.h"
#include "capture/skeleton_frame.h"
#include "capture/tracking/tracker.h"

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

namespace lorica {

/// Gives each tracked person a place, in the order of coming: the place of one avatar. Who is lost keeps the place for
/// kKeptSeconds: whoever comes then takes the kept place that was left nearest to them. Later it is free. People
/// without a place are ignored.
class PeoplePlaces {
 public:
  static constexpr double kKeptSeconds = 2.0;
  /// So long a lost person counts as there, with unknown joints: a tracker loses people for some frames.
  static constexpr double kLostSeconds = 0.5;

  /// @param count  of the places, at least 1
  explicit PeoplePlaces(int count);

  /// Assigns the people of one frame. Allocates nothing.
  /// @param people  everyone who is tracked, by increasing user number
  /// @param time    of the frame [s], rising
  void update(std::span<const TrackedPerson> people, double time);

  /// One for each place: the person's joints with the place's number from 1 as user, and the time of the frame. Joints
  /// are unknown without a person; SkeletonFrame::user is kNobody if none is there.
  [[nodiscard]] std::span<const SkeletonFrame> frames() const { return frames_; }

 private:
  struct Place {
    int user = 0;  ///< of the tracker; 0 = nobody now
    std::optional<double> seen;
    Vec3 torso = Vec3::Zero();  ///< where it was seen last [m]
  };
  [[nodiscard]] Place* placeFor(const TrackedPerson& newcomer, double time);

  std::vector<Place> places_;
  std::vector<SkeletonFrame> frames_;
};

/// Moves a person with their head: by what the headset has moved since the image, the feet not at all, what is between
/// by its height. The head is then where the headset is. Of another's headset nothing happens.
/// @param then    the head in the image, in the person's frame
/// @param latest  the head now
void moveWithHead(const WornHead& then, const WornHead& latest, SkeletonFrame& person);

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

/// Runs DepthJoints on its own thread: every image of a live camera is tracked, however long the caller takes to draw.
/// next() returns the latest joints; joints not fetched in time are skipped.
class LiveJoints final : public SkeletonSource {
 public:
  /// Starts tracking.
  explicit LiveJoints(DepthJoints joints);

  /// Waits for joints newer than those of the last call.
  [[nodiscard]] Result<std::optional<SkeletonFrame>> next() override;

  /// Whether the last next() was the end.
  [[nodiscard]] bool ended() const { return ended_; }
  /// Whether next() would return without waiting.
  [[nodiscard]] bool ready() const;

  [[nodiscard]] const DepthSource& source() const { return joints_.source(); }
  /// Of the last next().
  [[nodiscard]] const DepthSight& sight() const { return sight_; }
  /// Number of images tracked up to the last next(), and of those that showed a person.
  [[nodiscard]] int frameCount() const { return frameCount_; }
  [[nodiscard]] int followedCount() const { return followedCount_; }

 private:
  void run(const std::stop_token& stop);

  DepthJoints joints_;  ///< used by the thread only

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Result<std::optional<SkeletonFrame>>> latest_;  ///< empty once it was returned
  DepthSight latestSight_;
  int latestFrameCount_ = 0, latestFollowedCount_ = 0;

  DepthSight sight_;  ///< used by the caller only
  int frameCount_ = 0, followedCount_ = 0;
  bool ended_ = false;
  std::jthread thread_;  ///< is ended first
};

/// The joints of a further place, see DepthSight::places: those of the last next() of the first place's source.
/// @param joints  of several people; outlives the source
/// @param place   from 1
[[nodiscard]] std::unique_ptr<SkeletonSource> makePlaceSource(const LiveJoints& joints, std::size_t place);

}  // namespace lorica
