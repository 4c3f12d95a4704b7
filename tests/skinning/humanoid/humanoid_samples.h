#pragma once

#include "skinning/humanoid/humanoid.h"

#include <array>
#include <map>
#include <span>
#include <string>
#include <string_view>

namespace lorica::test {

/// Bone names of a rig. In a name % is the side, @ the finger, # the finger's segment.
struct RigNames {
  std::string_view rig;
  std::string_view by;  ///< expected HumanoidGuess::by
  std::string_view left;
  std::string_view right;
  std::array<std::string_view, 6> trunk;  ///< hips, spine, chest, upper chest, neck, head; "" if it has none
  std::array<std::string_view, 4> leg;    ///< upper, lower, foot, toes
  std::array<std::string_view, 4> arm;    ///< shoulder, upper, lower, hand
  std::string_view finger;                ///< "" if it has no fingers
  std::array<std::string_view, 5> fingers;
  std::array<std::string_view, 3> segments;
};

/// A rig whose lists are written "a,b,c"; sides are "left,right".
[[nodiscard]] RigNames rigOf(std::string_view rig, std::string_view by, std::string_view sides, std::string_view trunk,
                             std::string_view leg, std::string_view arm, std::string_view finger = "",
                             std::string_view fingers = "", std::string_view segments = "1,2,3");

[[nodiscard]] std::span<const RigNames> rigNames();

/// The skeleton without marks of bones.
[[nodiscard]] Skeleton withoutBones(const Skeleton& skeleton);

[[nodiscard]] bool isDoubted(const HumanoidGuess& guess, HumanBone bone);

/// Bone names of a rig for both sides, without the bones that it lacks.
[[nodiscard]] std::map<HumanBone, std::string> namesOf(const RigNames& rig);

/// The mannequin's skeleton with only these joints, with these names, none marked as a bone.
[[nodiscard]] Skeleton renamedMannequin(const std::map<HumanBone, std::string>& names);

/// The names of the joints that a guess assigns to each bone.
[[nodiscard]] std::map<HumanBone, std::string> namesOf(const Skeleton& skeleton, const HumanoidGuess& guess);

/// Differences between the guess and the truth, one line each; empty if they agree.
[[nodiscard]] std::string differences(const std::map<HumanBone, std::string>& expected,
                                      const std::map<HumanBone, std::string>& found);

/// Violations, one line each: a joint not below that of the parent bone, or assigned to two bones; empty if none.
[[nodiscard]] std::string contradictions(const Skeleton& skeleton, const HumanoidGuess& guess);

}  // namespace lorica::test
