#pragma once

#include "capture/confidence_hold.h"
#include "capture/skeleton_frame.h"
#include "skinning/skeleton.h"

#include <span>
#include <vector>

namespace lorica {

/// Turns tracked joints into a pose of one character: each bone takes the direction of its limb, twist comes from
/// the orientation where one is given, the root moves by the source's motion scaled by leg length, the feet stay
/// on the floor. Joints without confidence hold, then ease to rest.
class Retargeter {
 public:
  /// @return the retargeter, or which humanoid bones the skeleton lacks
  static Result<Retargeter> create(const Skeleton& skeleton, const ConfidenceHoldSettings& hold = {});

  /// @param pose  jointCount local transforms, written
  void apply(const SkeletonFrame& frame, std::span<JointTransform> pose);

 private:
  Retargeter(const Skeleton& skeleton, const ConfidenceHoldSettings& hold);
  // The author of retarget.cpp declares here what the solver keeps.
  Skeleton skeleton_;
  ConfidenceHold hold_;
};

}  // namespace lorica
