#pragma once

#include "capture/skeleton_frame.h"
#include "geometry/result.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <vector>

namespace lorica {

struct SkeletalRetargetSettings {
  bool mirror = false;  ///< exchange left and right
  /// Feet that stand still in the source stand still in the target, and none goes below the floor: legs bend for this.
  /// If false, limbs point exactly as the source's do.
  bool plantFeet = true;
};

/// Transfers the motion of one humanoid skeleton to another, whatever their rest poses, joint axes and lengths. Limbs
/// take the source's directions and twists, and so do feet, toes, hands, fingers, neck and head if both skeletons have
/// them. The bend of the spine is distributed over the target's spine bones. Bones that the source lacks (hands, feet,
/// toes, whole limbs), and joints that are not bones, stay at rest. If the source lacks a leg, the target stands on the
/// lowest point of its feet.
///
/// The root follows the source's root, scaled by the ratio of leg lengths, from its start position. The source's floor
/// is the height that its soles rarely go below; the target's floor is y = 0, and its lower foot is as high above it as
/// the source's, scaled.
///
/// During a stance (contactsOf()) the foot follows the source's scaled path, offset to its mean position from the
/// limb directions over the stance; before and after, the offset blends in and out within 0.15 s. The root follows the
/// mean correction of both feet; hip and knee bend for the rest, in their current plane of bending, knees forwards. If
/// a leg is too short, the root is lowered smoothly.
/// @param target  with its humanoid bones
/// @return the motion on the target's skeleton, frame for frame; or an error with the humanoid bones that the target
/// lacks, or the source if it has no trunk or no limb with an upper and a lower bone
[[nodiscard]] Result<SkeletalMotion> retargetMotion(const SkeletalMotion& source, const Skeleton& target,
                                                    const SkeletalRetargetSettings& settings = {});

/// The same onto a character, also one whose skeleton lacks bones or has them elsewhere: through a ProxySkeleton.
[[nodiscard]] Result<SkeletalMotion> retargetMotion(const SkeletalMotion& source, const Character& target,
                                                    const SkeletalRetargetSettings& settings = {});

/// The bones of hands, feet, arms and legs that retargetMotion() leaves at rest in any target, because the source does
/// not define them. @return empty if the source has all of these; or the reason why it cannot be retargeted
[[nodiscard]] Result<std::vector<HumanBone>> bonesLeftAtRest(const Skeleton& source);

/// Transfers a motion to a skeleton with joints of the same names, ignoring a scene prefix before a colon: each joint
/// takes the local transform of the joint of the same name. Bones keep the target's lengths; hips and joints that
/// translate relative to their parents take the source's position, scaled by the ratio of the skeletons' sizes. If
/// other joints lie between two matched joints, or above the topmost ones, the transform from one to the other, or in
/// the world, is used. Unmatched joints stay at rest.
/// @return the motion on the target's skeleton, or an error if too few names match (fewer than half of the moving
/// joints)
[[nodiscard]] Result<SkeletalMotion> retargetByJointNames(const SkeletalMotion& source, const Skeleton& target);

/// The 15 tracked joints of a skeletal motion as a sensor would report them: positions in the world and orientations,
/// with confidence 1 for bones that the skeleton has. The torso is midway from hips to neck. A missing hand or foot is
/// guessed straight ahead of its limb, with confidence 0.5. A floor more than 5 cm from y = 0 is moved to y = 0.
/// @return one frame per frame, or an error with the humanoid bones that the skeleton lacks, as for retargetMotion()
[[nodiscard]] Result<std::vector<SkeletonFrame>> bodyJointsOf(const SkeletalMotion& motion);

/// The inverse: a skeleton of the 15 joints under the middle of the hips, and its motion. Bone lengths are medians over
/// the frames and the same on both sides. Unseen joints hold, then ease to rest.
/// @param frames  at least one
[[nodiscard]] Result<SkeletalMotion> skeletalMotionOf(const std::vector<SkeletonFrame>& frames);

}  // namespace lorica
