#pragma once

#include "capture/headset/head_and_hands.h"
#include "capture/headset/worn_headset.h"
#include "capture/skeleton_frame.h"
#include "capture/standing_legs.h"

#include <array>
#include <memory>

namespace lorica {

/// The body of a person of whom only head and hands are known, as a headset and its controllers tell them.
///
/// The height is that of the eyes of the person who stands as tall as they were ever seen; lengths follow from it
/// (adults' proportions, R. Drillis and R. Contini, "Body Segment Parameters", 1966). The chest turns with head and
/// hands, a look down with a lowered head bends the trunk, a lowered head alone bends the knees. Elbows lie in the
/// plane that hangs down from shoulder and hand, turned by how the hand is held. Feet step after the hips, see
/// StandingLegs. A hand that is not seen hangs down. What is inferred has a confidence of 0.5. The same poses give the
/// same joints; use one instance per person. Allocates nothing.
class ThreePointBody {
 public:
  /// @param known  finite, with times that rise
  /// @return joints, with the head and the hands that are seen where they are, to the tracker's definition of a head
  [[nodiscard]] SkeletonFrame follow(const HeadAndHands& known);

 private:
  struct Arm {
    Vec3 hand{0, 0, 0};  ///< in the frame of the chest, below the shoulder [m]
    Vec3 bend{0, 0, 0};  ///< where the elbow points [unit]
    double shown = 0.0;  ///< share of the hand that is seen in where it is
    Quat turned = Quat::Identity();
  };

  void bendArm(std::size_t side, const HeadAndHands& known, const Isometry3& worldFromChest, double step,
               SkeletonFrame& frame);

  StandingLegs legs_{StandingLegs::Use::kOnKnownFloor};
  std::array<Arm, 2> arms_;
  double eyeHeight_ = 0.0;  // of the person who stands upright [m]; 0 = not seen yet
  double reach_ = 1.0;      // length of the arms, times that which follows from the height
  double yaw_ = 0.0;        // of the chest [rad]
  double lean_ = 0.0;       // of the trunk, forward [rad]
  double time_ = 0.0;       // of the last pose [s]
};

/// The wearer of a headset as a person, see ThreePointBody: next() takes the newest pose and never waits. Before the
/// first pose nobody is there; without another one the person stays as they are.
[[nodiscard]] std::unique_ptr<SkeletonSource> makeThreePointJoints(std::shared_ptr<const WornHeadset> headset);

}  // namespace lorica
