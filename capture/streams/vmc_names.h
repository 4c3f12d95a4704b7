#pragma once

#include "skinning/skeleton.h"

#include <optional>
#include <string_view>

namespace lorica {

/// The name of a bone in the VMC protocol, which is Unity's (HumanBodyBones): "LeftUpperArm".
[[nodiscard]] std::string_view vmcNameOf(HumanBone bone);

/// The inverse. Also takes VRM 1.0's names ("leftUpperArm"), which some programs send. Eyes, jaw and unknown names give
/// nothing.
[[nodiscard]] std::optional<HumanBone> vmcBoneNamed(std::string_view name);

}  // namespace lorica
