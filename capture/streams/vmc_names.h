#pragma once

#include "skinning/skeleton.h"

#include <optional>
#include <string>
#include <string_view>

namespace lorica {

/// The name of a bone in the VMC protocol, which is Unity's (HumanBodyBones): "LeftUpperArm".
[[nodiscard]] std::string_view vmcNameOf(HumanBone bone);

/// The inverse. Also takes VRM 1.0's names ("leftUpperArm"), which some programs send. Eyes, jaw and unknown names give
/// nothing.
[[nodiscard]] std::optional<HumanBone> vmcBoneNamed(std::string_view name);

/// The name of an expression as it is sent: of a preset VRM 0.x's, such as "Joy" and "Blink_L", which all receivers
/// know; of others their own. @param name  as in Expression::name
[[nodiscard]] std::string vmcExpressionNamed(std::string_view name);

}  // namespace lorica
