#pragma once

#include "capture/retarget/foot_contacts.h"
#include "capture/retarget/retarget_rig.h"
#include "skinning/clip.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// What a pose says of a body, whatever the skeleton that holds it.
struct HumanPose {
  /// worldFromLimb in TrackedJoint's sense: identity in T-pose, facing +Z. Those of upper and lower limbs point exactly
  /// as the joints lie. Nothing where the skeleton lacks the bone.
  std::array<std::optional<Quat>, kHumanBoneCount> turn;
  Vec3 middleHip = Vec3::Zero();  ///< [m]
  std::array<FootPlace, 2> foot;  ///< left, right

  [[nodiscard]] const std::optional<Quat>& operator[](HumanBone bone) const {
    return turn[static_cast<std::size_t>(bone)];
  }
};

/// Reads poses of a humanoid skeleton, and poses it. Feet are turned by the heading of the line from ankle to toes
/// here, and necks by the line from neck to head, as limbs are by theirs: what is only their shape is taken out.
/// Internal to the retargeting of motions.
class HumanBody {
 public:
  /// @return the body, or which humanoid bones the skeleton lacks
  static Result<HumanBody> create(const Skeleton& skeleton);

  [[nodiscard]] const RetargetRig& rig() const { return rig_; }

  /// @param pose  jointCount local transforms
  [[nodiscard]] HumanPose read(std::span<const JointTransform> pose);

  /// Gives every bone the turn of its like; bones and joints without one keep their rest rotation in their parent. The
  /// hips' place is left at rest.
  /// @param spineTurns  from the hips up, at least one; shared out along this spine so that its whole bend is theirs
  /// @param pose        jointCount local transforms, written
  void pose(const HumanPose& human, std::span<const Quat> spineTurns, std::span<JointTransform> pose);

  /// Turns from the hips to the topmost spine bone: hips, then each spine bone that there is.
  [[nodiscard]] std::vector<Quat> spineTurnsOf(const HumanPose& human) const;

  /// What is known after pose() or read(), of that pose.
  [[nodiscard]] Vec3 placeOf(HumanBone bone) const;
  [[nodiscard]] const Quat& worldRotation(JointIndex joint) const {
    return worldRotation_[static_cast<std::size_t>(joint)];
  }
  [[nodiscard]] Vec3 middleHip() const;
  [[nodiscard]] FootPlace footPlace(std::size_t side) const;

  /// Brings an ankle to a place by bending the leg; the foot keeps its turn in the world.
  void reach(std::size_t side, const Vec3& ankle, std::span<JointTransform> pose);
  /// Moves the whole body. @param by  [m]
  void move(const Vec3& by, std::span<JointTransform> pose);

 private:
  explicit HumanBody(RetargetRig rig);
  void evaluate(std::span<const JointTransform> pose);

  RetargetRig rig_;
  std::vector<Quat> tposeFromJoint_;  ///< rig_'s, the shapes of feet and neck taken out
  std::vector<HumanBone> spine_;      ///< hips, then those of spine, chest and upperChest that there are
  std::vector<Quat> worldRotation_;
  std::vector<Affine3> worldFromJoint_;
};

}  // namespace lorica
