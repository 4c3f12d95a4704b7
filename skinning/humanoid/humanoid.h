#pragma once

#include "skinning/skeleton.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// The bone that a bone hangs on in VRM's order of bones; nothing for the hips.
[[nodiscard]] std::optional<HumanBone> parentBone(HumanBone bone);

/// Which joint is which humanoid bone, and how that was found out.
struct HumanoidGuess {
  std::array<JointIndex, kHumanBoneCount> jointOf{};  ///< kNoJoint where the skeleton lacks it
  std::string by;  ///< "names (Mixamo)", "names (CMU)", "the skeleton's shape", ...; empty when nothing was found

  [[nodiscard]] JointIndex operator[](HumanBone bone) const { return jointOf[static_cast<std::size_t>(bone)]; }
};

/// Finds the humanoid bones of a skeleton: by the names of its joints, as VRM, Mixamo, CMU, MakeHuman, 3ds Max Biped,
/// Kinect v1 and v2, NiTE and others write them, and where names say nothing, by the skeleton's shape in its rest
/// pose: two legs down from the hips, two arms and a head up from the chest. Left is at +X of one who faces +Z; a
/// skeleton that faces elsewhere is told by its feet, its knees, or its names. Of one that lacks legs, the rest by
/// names.
/// @param skeleton  Y up, in metres; bones that it already has are kept
[[nodiscard]] HumanoidGuess guessHumanoid(const Skeleton& skeleton);

/// The same skeleton with the bones of a guess, and no others.
[[nodiscard]] Skeleton withBones(const Skeleton& skeleton, const HumanoidGuess& bones);

}  // namespace lorica
