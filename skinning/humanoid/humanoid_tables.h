#pragma once

#include "skinning/skeleton.h"

#include <array>
#include <span>
#include <string_view>

namespace lorica {

/// The bones that conventions name. Names of a left bone also apply to the right one. Those of kSpine are all joints of
/// the trunk; their order is given by the skeleton.
inline constexpr std::array kNamedBones = {HumanBone::kHips,
                                           HumanBone::kSpine,
                                           HumanBone::kNeck,
                                           HumanBone::kHead,
                                           HumanBone::kLeftUpperLeg,
                                           HumanBone::kLeftLowerLeg,
                                           HumanBone::kLeftFoot,
                                           HumanBone::kLeftToes,
                                           HumanBone::kLeftShoulder,
                                           HumanBone::kLeftUpperArm,
                                           HumanBone::kLeftLowerArm,
                                           HumanBone::kLeftHand,
                                           HumanBone::kLeftMiddleProximal};

/// How one convention names each of these bones: in lower case, joined ("UpLeg" is upleg), without side, prefix or
/// leading zeros; several names are separated by blanks, the best first. Empty = it has no such bone.
struct NamingConvention {
  std::string_view name;
  std::array<std::string_view, kNamedBones.size()> names;
};

/// All known conventions; the last one mixes all of them.
[[nodiscard]] std::span<const NamingConvention> namingConventions();

}  // namespace lorica
