#pragma once

#include "capture/skeleton_frame.h"
#include "geometry/result.h"
#include "skinning/clip.h"

#include <vector>

namespace lorica {

struct MotionRetargetSettings {
  bool mirror = false;  ///< left becomes right
  /// Feet that stand still in the source stand still in the target, and none goes under the floor: legs bend for it.
  /// Without it limbs point exactly as the source's do.
  bool plantFeet = true;
};

/// Carries a motion of one humanoid skeleton over to another one, whatever the rest poses, joint axes and lengths of
/// both: limbs take the directions of the source's, twists about them too, and so do feet, toes, hands, fingers, neck
/// and head that both have. The bend of the spine is shared out over the bones of the target's. Bones that the source
/// lacks, and joints that are no bones, stay at rest: hands, feet, toes, whole limbs. Where the source lacks a leg, the
/// target stands on what is lowest of its feet.
///
/// The root follows the source's by the ratio of leg lengths, from where it starts. The source's floor is where its
/// soles seldom go below; the target's is y = 0, and its lower foot is as high above it as the source's, scaled.
///
/// A stance (foot_contacts.h) keeps the foot on the source's way, scaled, from where the limbs' directions put it in
/// the mean of the stance; before and after it the foot comes and goes within 0.15 s. The root goes along with what
/// both feet ask for in the mean; for the rest hip and knee bend, in the plane in which they bend already, knees
/// forwards. Where a leg is too short the root comes down, smoothly.
/// @param target  with its humanoid bones
/// @return the motion on the target's skeleton, frame for frame; or which humanoid bones the target lacks, or the
///         source, where it has no trunk or no limb with an upper and a lower bone
[[nodiscard]] Result<SkeletalMotion> retargetMotion(const SkeletalMotion& source, const Skeleton& target,
                                                    const MotionRetargetSettings& settings = {});

/// Which bones of any target retargetMotion() leaves at rest since a source says nothing of them: of hands, feet and
/// the bones of arms and legs. @return none for a source that has all of these; or why it cannot be carried over
[[nodiscard]] Result<std::vector<HumanBone>> bonesLeftAtRest(const Skeleton& source);

/// A motion onto a skeleton that has joints of the same names, a scene's name before a colon aside: each takes the
/// local transform of its namesake. Bones keep the lengths that they have here; hips and joints that move in their
/// parents go where their namesakes are, by the ratio of the skeletons' sizes. Where other joints lie between two
/// namesakes, or above the topmost ones, the transform from one to the other, or in the world, is taken. Joints without
/// a namesake stay at rest.
/// @return the motion on the target's skeleton, or that too few names agree (fewer than half of the moving joints)
[[nodiscard]] Result<SkeletalMotion> renameMotion(const SkeletalMotion& source, const Skeleton& target);

/// The 15 tracked joints of a skeletal motion, as a sensor would have given them, all with confidence 1 where the
/// skeleton has the bone: positions in the world, orientations included. The torso is midway from hips to neck. A hand
/// or foot that the skeleton lacks is guessed, straight ahead of its limb, with confidence 0.5. A floor further than 5
/// cm from y = 0 is brought there.
/// @return one frame a frame, or which humanoid bones the skeleton lacks, as retargetMotion()
[[nodiscard]] Result<std::vector<SkeletonFrame>> bodyJointsOf(const SkeletalMotion& motion);

/// The other way: a skeleton of the 15 joints under the middle of the hips, its bones as long as they are in the median
/// of the frames and the same on both sides, and its motion. Joints that are not seen hold, then ease to rest.
/// @param frames  at least one
[[nodiscard]] Result<SkeletalMotion> skeletalMotionOf(const std::vector<SkeletonFrame>& frames);

}  // namespace lorica
