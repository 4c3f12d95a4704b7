#pragma once

#include "capture/headset/head_and_hands.h"
#include "capture/registration/head_registration.h"

#include <mutex>
#include <optional>
#include <vector>

namespace lorica {

/// Where a registered headset says that its wearer's head is, floor frame.
struct WornHead {
  Vec3 position = Vec3::Zero();         ///< of the tracker's head joint [m]
  Quat orientation = Quat::Identity();  ///< as in TrackedJoint
  /// Unit, level: where the headset looks.
  [[nodiscard]] Vec3 ahead() const { return (orientation * Vec3::UnitX()).cross(Vec3::UnitY()).normalized(); }
};

/// The headset of a person: whoever receives its poses tells what follows its wearer, a depth camera's tracker in its
/// thread or ThreePointBody. Times are of one monotonic clock [s]. Allocates nothing after construction.
class WornHeadset {
 public:
  static constexpr double kGone = 0.3;  ///< without a pose, the headset was taken off [s]

  WornHeadset() { poses_.reserve(kMost); }
  /// @param registration  none = not yet known, or no longer
  void setRegistration(const std::optional<Registration>& registration);
  /// @param position, orientation  stage frame; as HeadRegistration::addHeadset() takes them
  void add(double time, const Vec3& position, const Quat& orientation);
  /// The same with the hands; what is not finite is not seen.
  void add(const HeadAndHands& pose);
  void restart();  ///< forgets all poses, as when another run begins

  /// The one that was set; none = not known.
  [[nodiscard]] std::optional<Registration> registration() const;
  /// Where the head was that an image shows. @param time  when the image came
  [[nodiscard]] std::optional<WornHead> inImage(double time) const;
  /// Where the head is by the last pose.
  [[nodiscard]] std::optional<WornHead> latest(double now) const;
  /// The last pose of head and hands, stage frame; none before the first one.
  [[nodiscard]] std::optional<HeadAndHands> newest() const;

 private:
  static constexpr std::size_t kMost = 128;
  [[nodiscard]] WornHead headOf(const Vec3& position, const Quat& orientation) const;

  mutable std::mutex mutex_;
  std::optional<Registration> registration_;
  std::vector<HeadRegistration::HeadsetPose> poses_;
  std::optional<HeadAndHands> newest_;
};

}  // namespace lorica
