#pragma once

#include "geometry/counts.h"
#include "skinning/skeleton.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// The parent of a bone in VRM's hierarchy; none for the hips.
[[nodiscard]] std::optional<HumanBone> parentBone(HumanBone bone);

/// Bones that may be wrong.
struct BoneDoubt {
  std::vector<HumanBone> bones;
  std::string reason;  ///< "the arms are not alike"
};

/// "leftHand, rightHand: the arms are not alike".
[[nodiscard]] std::string inWords(const BoneDoubt& doubt);

/// The joint of each humanoid bone, and how it was found.
struct HumanoidGuess {
  std::array<JointIndex, kHumanBoneCount> jointOf{};  ///< kNoJoint if the skeleton lacks the bone
  std::string by;  ///< "names (Mixamo)", "names (CMU)", "the skeleton's shape", ...; empty if nothing was found
  std::vector<BoneDoubt> doubts;  ///< only of a shape; a user should check these bones

  [[nodiscard]] JointIndex operator[](HumanBone bone) const { return jointOf[ordinalOf(bone)]; }
};

/// Finds the humanoid bones of a skeleton.
///
/// Joint names are tried first, in the conventions of VRM, Mixamo, CMU, MakeHuman, 3ds Max Biped, Kinect v1 and v2,
/// NiTE and others. If they match no convention, the skeleton's shape in its rest pose is used: two legs down from the
/// hips, two arms and a head up from the chest. A skeleton that faces +Z has its left at +X; other facing directions
/// are determined by the feet, the knees or side words in the names. Limbs may be irregular: one arm goes on as a tool,
/// or is one; then the doubts say so. For a skeleton that lacks legs, only names are used.
/// @param skeleton  Y up, in metres; bones that it already has are kept
[[nodiscard]] HumanoidGuess guessHumanoid(const Skeleton& skeleton);

/// The same; but if that finds nothing, the bones that joints at mirrored places suggest, all of them in doubt. To be
/// shown to a user, not to be used as it is.
[[nodiscard]] HumanoidGuess suggestHumanoid(const Skeleton& skeleton);

/// The same skeleton with exactly the bones of a guess.
[[nodiscard]] Skeleton withBones(const Skeleton& skeleton, const HumanoidGuess& bones);

}  // namespace lorica
