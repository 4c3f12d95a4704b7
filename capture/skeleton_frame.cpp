#include "capture/skeleton_frame.h"

namespace lorica {

std::string_view nameOf(BodyJoint joint) {
  switch (joint) {
    case BodyJoint::kHead:
      return "head";
    case BodyJoint::kNeck:
      return "neck";
    case BodyJoint::kLeftShoulder:
      return "left_shoulder";
    case BodyJoint::kRightShoulder:
      return "right_shoulder";
    case BodyJoint::kLeftElbow:
      return "left_elbow";
    case BodyJoint::kRightElbow:
      return "right_elbow";
    case BodyJoint::kLeftHand:
      return "left_hand";
    case BodyJoint::kRightHand:
      return "right_hand";
    case BodyJoint::kTorso:
      return "torso";
    case BodyJoint::kLeftHip:
      return "left_hip";
    case BodyJoint::kRightHip:
      return "right_hip";
    case BodyJoint::kLeftKnee:
      return "left_knee";
    case BodyJoint::kRightKnee:
      return "right_knee";
    case BodyJoint::kLeftFoot:
      return "left_foot";
    case BodyJoint::kRightFoot:
      return "right_foot";
  }
  return "unknown";
}

}  // namespace lorica
