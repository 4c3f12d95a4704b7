#pragma once

#include "skinning/skeleton.h"

namespace lorica {

/// Where a bone's joint lies in the mannequin's T-pose, model space [m]. Right is left mirrored in x = 0.
[[nodiscard]] Vec3 mannequinJoint(HumanBone bone);

/// The bone on the other side of the body; a bone of the middle is its own mirror image.
[[nodiscard]] HumanBone mirrored(HumanBone bone);

/// All human bones; hips is the root; every rest rotation is the identity.
[[nodiscard]] Skeleton makeMannequinSkeleton();

}  // namespace lorica
