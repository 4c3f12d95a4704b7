#pragma once

#include "collision/live/choose_cover.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <span>
#include <vector>

namespace lorica {

/// Poses to choose a cover in and, apart from them, poses to measure it in: see chooseCover().
struct CoverPoses {
  std::vector<Affine3> sampled, heldOut;  ///< worldFromModel, poses x jointCount, pose-major
  int jointCount = 0;
  int randomPoses = 0;  ///< of the sampled ones, and as many of those held out: the last ones of each

  [[nodiscard]] BonePoseView sampledView() const { return {sampled, jointCount}; }
  [[nodiscard]] BonePoseView heldOutView() const { return {heldOut, jointCount}; }
};

inline constexpr int kCoverPoses = 128;

/// Half of the poses are frames of motions, taken evenly over all of them laid end to end, sampled ones and held-out
/// ones in turn. Where there are fewer frames than that, each is taken once. The other half are random poses within a
/// human's joint limits, standing at the origin; those held out have other seeds.
///
/// Random poses need a humanoid whose bones rest along the model's axes, see randomPoseWithinLimits(). Of another
/// character, and without motions, the poses of the other kind make up for it. The same input gives the same poses.
/// @param motions  of the character's skeleton
/// @param count    sampled poses, and as many held out; 2 or more
/// @return the poses, or that there is nothing to take poses from (kInvalidArgument)
[[nodiscard]] Result<CoverPoses> coverPoses(const Character& character, std::span<const SkeletalMotion> motions,
                                            int count = kCoverPoses);

}  // namespace lorica
