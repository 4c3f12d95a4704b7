#pragma once

#include "skinning/skeleton.h"

namespace lorica {

/// Position of a bone's joint in the mannequin's T-pose, model space [m]. The right side mirrors the left in x = 0.
[[nodiscard]] Vec3 mannequinJoint(HumanBone bone);

/// The bone on the other side of the body; a bone in the middle is its own mirror image.
[[nodiscard]] HumanBone mirrored(HumanBone bone);

/// A skeleton of all human bones; hips is the root; every rest rotation is the identity.
[[nodiscard]] Skeleton makeMannequinSkeleton();

}  // namespace lorica
