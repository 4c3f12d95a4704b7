#pragma once

#include "capture/skeleton_frame.h"
#include "geometry/result.h"
#include "skinning/clip.h"

#include <vector>

namespace lorica {

struct MotionRetargetSettings {
  bool mirror = false;    ///< left becomes right
  bool plantFeet = true;  ///< feet that stand still in the source stand still in the target
};

/// Carries a motion of one humanoid skeleton over to another one, whatever the rest poses, joint axes and lengths of
/// both: limbs take the directions of the source's, twists about them too; the root moves by the ratio of leg lengths.
/// Bones that the source lacks stay at rest.
/// @param target  with its humanoid bones
/// @return the motion on the target's skeleton, frame for frame; or which humanoid bones either of them lacks
[[nodiscard]] Result<SkeletalMotion> retargetMotion(const SkeletalMotion& source, const Skeleton& target,
                                                    const MotionRetargetSettings& settings = {});

/// A motion onto a skeleton that has joints of the same names: each takes the local transform of its namesake.
/// @return the motion on the target's skeleton, or that too few names agree (fewer than half of the moving joints)
[[nodiscard]] Result<SkeletalMotion> renameMotion(const SkeletalMotion& source, const Skeleton& target);

/// The 15 tracked joints of a skeletal motion, as a sensor would have given them, all with confidence 1 where the
/// skeleton has the bone: positions in the world, orientations included.
/// @return one frame a frame, or which humanoid bones the skeleton lacks
[[nodiscard]] Result<std::vector<SkeletonFrame>> bodyJointsOf(const SkeletalMotion& motion);

/// The other way: a skeleton of the 15 joints, its bones as long as they are in the median of the frames, and its
/// motion.
[[nodiscard]] Result<SkeletalMotion> skeletalMotionOf(const std::vector<SkeletonFrame>& frames);

}  // namespace lorica
