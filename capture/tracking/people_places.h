#pragma once

#include "capture/headset/worn_headset.h"
#include "capture/skeleton_frame.h"
#include "capture/tracking/tracker.h"

#include <optional>
#include <span>
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

}  // namespace lorica
