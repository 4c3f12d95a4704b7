#include "capture/skeleton_frame.h"

namespace lorica {

std::string_view nameOf(BodyJoint joint) {
  constexpr std::array<std::string_view, kBodyJointCount> kNames = {
      "head",  "neck",     "left_shoulder", "right_shoulder", "left_elbow", "right_elbow", "left_hand", "right_hand",
      "torso", "left_hip", "right_hip",     "left_knee",      "right_knee", "left_foot",   "right_foot"};
  const auto index = static_cast<std::size_t>(joint);
  return index < kNames.size() ? kNames[index] : "unknown";
}

}  // namespace lorica
