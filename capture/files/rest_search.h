#pragma once

#include "skinning/clip.h"

#include <string>

namespace lorica {

/// A pose in which a skeleton's body stands straight.
struct RestPose {
  Pose pose;
  bool isZero = false;  ///< the skeleton's own rest pose
  std::string words;    ///< "the zero pose, a T-pose", "frame 0, an A-pose"
};

/// "a T-pose", "an A-pose", "an I-pose" by how the arms hang, "straight" without arms; or "no usual pose" if the body
/// does not stand with straight limbs. Empty if the skeleton has neither two legs nor two arms.
[[nodiscard]] std::string namePose(const Skeleton& skeleton, std::span<const JointTransform> pose);

/// Finds the rest pose of a motion whose file does not say it: joints' axes may be those of the bones.
///
/// Poses are judged in the frame of their own trunk, so that the file's axes and unit do not matter: thighs and shins
/// point down, the head is above the neck, the trunk is not wrung, feet point ahead, arms are straight and hang in the
/// plane of the trunk, anywhere from level to down. The zero pose is kept if its limbs do so within 50 degrees. Else it
/// is the straightest of up to 256 frames, or frame 0 if that is as straight within 10 degrees. If no frame is straight
/// within 35 degrees, every limb is taken from the frame in which it is straightest, and its elbow or knee unbent. A
/// zero pose that none of them surpasses by 20 degrees is kept.
/// @param motion  with its humanoid bones; at rest every rotation is zero
[[nodiscard]] RestPose findRestPose(const SkeletalMotion& motion);

}  // namespace lorica
