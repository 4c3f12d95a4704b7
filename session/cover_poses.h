#pragma once

#include "capture/skeleton_frame.h"
#include "collision/cover.h"
#include "skinning/character.h"

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

/// Half of the poses are frames of recordings, posed as a session does: taken evenly over all recordings laid end to
/// end, sampled ones and held-out ones in turn. Where there are fewer frames than that, each is taken once. The other
/// half are random poses within a human's joint limits, standing at the origin; those held out have other seeds.
///
/// Random poses need a skeleton whose bones rest along the model's axes, see randomPoseWithinLimits(). Of another one,
/// and without recordings, the poses of the other kind make up for it. The same input gives the same poses.
/// @param count  sampled poses, and as many held out; 2 or more
/// @return the poses, or which humanoid bones the character lacks: without them no recording can pose it, nor is
///         anything known of its joints' limits; or that there is nothing to take poses from (kInvalidArgument)
[[nodiscard]] Result<CoverPoses> coverPoses(const Character& character,
                                            std::span<const std::vector<SkeletonFrame>> recordings,
                                            int count = kCoverPoses);

}  // namespace lorica
