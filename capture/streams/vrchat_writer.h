#pragma once

#include "capture/retarget/bone_pose.h"
#include "capture/skeleton_frame.h"

#include <array>
#include <bitset>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace lorica {

/// Groups of VRChat's trackers that are sent: one bit for each of kVrchatTrackers.
inline constexpr std::array<std::string_view, 6> kVrchatTrackers = {"head", "waist", "chest",
                                                                    "feet", "knees", "elbows"};
using VrchatTrackers = std::bitset<kVrchatTrackers.size()>;

/// The person whom a character follows, in the stage of the headset that they wear.
struct StagedPerson {
  SkeletonFrame joints;  ///< world frame
  Isometry3 stageFromWorld = Isometry3::Identity();
};

/// Writes poses as VRChat's OSC trackers (https://docs.vrchat.com/docs/osc-trackers): one bundle a frame with head,
/// hips, chest, feet, knees and elbows. Positions are the joints', scaled to a user of 1.7 m, or those of the person in
/// the headset's stage; rotations are those of the bones, of knees and elbows those of thighs and upper arms, as Euler
/// angles in degrees that are applied in Unity's order Z, X, Y. Allocates nothing after construction.
class VrchatWriter {
 public:
  /// @param height  of the character [m], positive
  explicit VrchatWriter(double height, VrchatTrackers sent = VrchatTrackers().set());

  /// @param pose    in our axes
  /// @param person  joints that are unknown are not sent; null = the character's
  /// @return the packet, valid until the next call
  [[nodiscard]] std::span<const std::byte> write(const BonePose& pose, const StagedPerson* person = nullptr);

 private:
  double scale_;
  VrchatTrackers sent_;
  std::vector<std::byte> memory_;
};

/// Unity's eulerAngles of a rotation in Unity's axes [degrees]: R = Ry * Rx * Rz.
[[nodiscard]] Vec3 unityAngles(const Quat& rotation);

}  // namespace lorica
