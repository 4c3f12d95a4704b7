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

/// Groups of trackers that are sent: one bit for each of kTrackerGroups.
inline constexpr std::array<std::string_view, 6> kTrackerGroups = {"head", "waist", "chest", "feet", "knees", "elbows"};
using TrackerGroups = std::bitset<kTrackerGroups.size()>;

/// Who understands the trackers.
enum class TrackerReceiver {
  kVrchat,  ///< https://docs.vrchat.com/docs/osc-trackers
  kVmt,  ///< Virtual Motion Tracker, a driver of SteamVR: https://gpsnmeajp.github.io/VirtualMotionTrackerDocument/api/
};

/// The person whom a character follows, in the stage of the headset that they wear.
struct StagedPerson {
  SkeletonFrame joints;  ///< world frame
  Isometry3 stageFromWorld = Isometry3::Identity();
};

/// Writes poses as trackers: one bundle of OSC a frame with head, hips, chest, feet, knees and elbows, in Unity's axes.
/// Positions are the joints', scaled to a user of 1.7 m, or those of the person in the headset's stage; rotations are
/// those of the bones, of knees and elbows those of thighs and upper arms: for VRChat as Euler angles in degrees that
/// are applied in the order Z, X, Y, for Virtual Motion Tracker as quaternions in the room's space, without the head,
/// which SteamVR has from the headset. Allocates nothing after construction.
class TrackerWriter {
 public:
  /// @param height  of the character [m], positive
  TrackerWriter(TrackerReceiver receiver, double height, TrackerGroups sent = TrackerGroups().set());

  /// @param pose    in our axes
  /// @param person  joints that are unknown are not sent; null = the character's
  /// @return the packet, valid until the next call
  [[nodiscard]] std::span<const std::byte> write(const BonePose& pose, const StagedPerson* person = nullptr);
  /// Switches Virtual Motion Tracker's trackers off that were written; empty if there is none.
  [[nodiscard]] std::span<const std::byte> writeEnd();

 private:
  TrackerReceiver receiver_;
  double scale_;
  TrackerGroups sent_;
  std::bitset<9> on_;  ///< trackers of Virtual Motion Tracker that were written
  std::vector<std::byte> memory_;
};

/// Unity's eulerAngles of a rotation in Unity's axes [degrees]: R = Ry * Rx * Rz.
[[nodiscard]] Vec3 unityAngles(const Quat& rotation);

}  // namespace lorica
