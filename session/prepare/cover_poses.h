#pragma once

#include "collision/hulls/cover_choice.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <span>

namespace lorica {

inline constexpr int kCoverPoses = 128;  ///< of each kind

/// Half of the poses are frames of motions, taken at even intervals over the concatenated motions and assigned
/// alternately to the sampled and the held-out poses. If there are fewer frames, each is used once. The other half are
/// random poses within human joint limits, standing at the origin; the held-out ones have another seed.
///
/// Random poses need a humanoid whose bones rest along the model's axes, see randomPoseWithinLimits(). If one kind of
/// pose is not available, all poses are of the other kind. The same input gives the same poses.
/// @param motions  of the character's skeleton
/// @param count    number of sampled poses and of held-out poses, at least 2
/// @return the poses, or an error if neither kind is available (kInvalidArgument)
[[nodiscard]] Result<CoverPoses> coverPoses(const Character& character, std::span<const SkeletalMotion> motions,
                                            int count = kCoverPoses);

}  // namespace lorica
