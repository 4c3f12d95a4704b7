#pragma once

#include "capture/retarget/retarget_rig.h"
#include "capture/retarget/root_and_feet.h"
#include "skinning/clip.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// World rotations of thigh and shin that move an ankle to a position; child joints rotate along.
struct LegTurns {
  Quat thigh = Quat::Identity();
  Quat shin = Quat::Identity();
  Vec3 ankle = Vec3::Zero();  ///< reached position: the target, or the nearest point within the leg's length [m]
};

/// Bends a two-bone leg so that its ankle reaches a position. The plane of hip, knee and ankle rotates with the line
/// from hip to ankle, with minimal change of twist; a straight knee bends forwards.
/// @param hinge   unit axis about which the knee bends: rotating the thigh by a positive angle folds the shin back
/// @param wanted  target position [m], in world space like the others
[[nodiscard]] LegTurns reachWithLeg(const Vec3& hip, const Vec3& knee, const Vec3& ankle, const Vec3& hinge,
                                    const Vec3& wanted);

/// How far a hip must move straight down so that its ankle reaches a position [m]; 0 if it already does or never will.
/// The max reach is slightly below the leg length, because a fully straight knee snaps; a leg that is already
/// straighter may stay so.
[[nodiscard]] double dropToReach(const Vec3& hip, const Vec3& knee, const Vec3& ankle, const Vec3& wanted);

/// Computes world rotations, without scales, and world transforms of a pose. Allocates nothing.
/// @param worldRotation, worldFromJoint  one per joint, written
void evaluatePose(const Skeleton& skeleton, std::span<const JointTransform> pose, std::span<Quat> worldRotation,
                  std::span<Affine3> worldFromJoint);

/// The pose of a body, independent of the skeleton.
struct HumanPose {
  /// worldFromLimb rotations as defined for TrackedJoint: identity in T-pose, facing +Z. Those of upper and lower limbs
  /// point exactly along the line between the joints. Empty if the skeleton lacks the bone.
  std::array<std::optional<Quat>, kHumanBoneCount> turn;
  Vec3 middleHip = Vec3::Zero();     ///< [m]
  std::array<FootPosition, 2> foot;  ///< left, right

  [[nodiscard]] const std::optional<Quat>& operator[](HumanBone bone) const {
    return turn[static_cast<std::size_t>(bone)];
  }
};

/// Reads and writes poses of a humanoid skeleton, and is the body in the last one. The shape of feet and neck is
/// removed: the heading of a foot is that of the line from ankle to toes, the direction of a neck that of the line from
/// neck to head, as for limbs. Internal to motion retargeting.
class HumanRig : public PosedBody {
 public:
  /// @return the rig, or an error with the humanoid bones that the skeleton lacks
  static Result<HumanRig> create(const Skeleton& skeleton);

  /// @param pose  jointCount local transforms
  [[nodiscard]] HumanPose read(std::span<const JointTransform> pose);

  /// Sets every bone's rotation from the same bone in `human`; bones and joints without one keep their rest rotation in
  /// the parent. The position of the hips stays at rest.
  /// @param spineTurns  from the hips up, at least one; distributed along this spine so that it bends by the same total
  /// @param pose        jointCount local transforms, written
  void pose(const HumanPose& human, std::span<const Quat> spineTurns, std::span<JointTransform> pose);

  /// Rotations from the hips to the topmost spine bone: hips, then each existing spine bone.
  [[nodiscard]] std::vector<Quat> spineTurnsOf(const HumanPose& human) const;

 private:
  explicit HumanRig(RetargetRig ofSkeleton);

  std::vector<Quat> tposeFromJoint_;  ///< as in the rig, with the shapes of feet and neck removed
  std::vector<HumanBone> spine_;      ///< hips, then the existing ones of spine, chest and upperChest
};

/// Frames first to last, inclusive, in which a foot stands.
struct FootContact {
  int first = 0;
  int last = 0;
};

/// Floor height under a motion: the height that the lower sole rarely goes below [m]. Where the soles of planted feet
/// stay clearly above it, theirs: toes of a foot that swings may go below the floor.
/// @param feet       left, right: one position per frame, at least one
/// @param times      [s], increasing
/// @param legLength  as for contactsOf() [m]
[[nodiscard]] double floorUnder(const std::array<std::vector<FootPosition>, 2>& feet, std::span<const double> times,
                                double legLength);

/// Finds the intervals in which a foot stands: ankle or ball moves little from frame to frame and the sole is near the
/// floor, with hysteresis (stricter limits to start than to continue). A foot in the air also counts if the whole foot
/// rests for 0.25 s. Uses steps between adjacent frames instead of slopes over several, so that the first and last
/// frame of a stance are found.
/// @param positions  one per frame
/// @param times      [s], increasing
/// @param legLength  leg length of the moving body; limits hold for 0.85 m and scale with it [m]
[[nodiscard]] std::vector<FootContact> contactsOf(std::span<const FootPosition> positions,
                                                  std::span<const double> times, double floor, double legLength);

}  // namespace lorica
