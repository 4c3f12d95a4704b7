#pragma once

#include "skinning/skeleton.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// The parent of a bone in VRM's hierarchy; none for the hips.
[[nodiscard]] std::optional<HumanBone> parentBone(HumanBone bone);

/// The joint of each humanoid bone, and how it was found.
struct HumanoidGuess {
  std::array<JointIndex, kHumanBoneCount> jointOf{};  ///< kNoJoint if the skeleton lacks the bone
  std::string by;  ///< "names (Mixamo)", "names (CMU)", "the skeleton's shape", ...; empty if nothing was found

  [[nodiscard]] JointIndex operator[](HumanBone bone) const { return jointOf[static_cast<std::size_t>(bone)]; }
};

/// Finds the humanoid bones of a skeleton.
///
/// Joint names are tried first, in the conventions of VRM, Mixamo, CMU, MakeHuman, 3ds Max Biped, Kinect v1 and v2,
/// NiTE and others. If they match no convention, the skeleton's shape in its rest pose is used: two legs down from the
/// hips, two arms and a head up from the chest. A skeleton that faces +Z has its left at +X; other facing directions
/// are determined by the feet, the knees or side words in the names. For a skeleton that lacks legs, only names are
/// used.
/// @param skeleton  Y up, in metres; bones that it already has are kept
[[nodiscard]] HumanoidGuess guessHumanoid(const Skeleton& skeleton);

/// The same skeleton with exactly the bones of a guess.
[[nodiscard]] Skeleton withBones(const Skeleton& skeleton, const HumanoidGuess& bones);

}  // namespace lorica
