#pragma once

#include "collision/hulls/cover_choice.h"
#include "collision/hulls/training.h"
#include "session/prepare/motion.h"
#include "session/prepare/read_motion.h"
#include "session/prepare/subject.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <span>
#include <string>
#include <vector>

namespace lorica {

/// The given motions; if there are none, the character's own clips and, for a humanoid, the motions that Lorica ships,
/// since it may be moved by either; else its rest pose.
/// @param given  may be empty
/// @param clips  of the character's skeleton; may be empty
[[nodiscard]] Result<Training> trainingMotions(const Character& character, std::span<const Motion> given,
                                               std::span<const Clip> clips);

/// Reads motions by paths or names, see readMotion().
[[nodiscard]] Result<std::vector<Motion>> readMotions(std::span<const std::string> names, Host& host);

/// The same for a subject.
/// @param motions  may be empty
[[nodiscard]] Result<Training> trainingMotions(const Subject& subject, std::span<const Motion> motions);

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
