#pragma once

#include "skinning/humanoid/humanoid.h"

#include <array>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica::test {

/// What a rig calls its bones. In a name % stands for the side, @ for the finger, # for the finger's segment.
struct RigNames {
  std::string_view rig;
  std::string_view by;  ///< what guessHumanoid() should say
  std::string_view left;
  std::string_view right;
  std::array<std::string_view, 6> trunk;  ///< hips, spine, chest, upper chest, neck, head; "" where it has none
  std::array<std::string_view, 4> leg;    ///< upper, lower, foot, toes
  std::array<std::string_view, 4> arm;    ///< shoulder, upper, lower, hand
  std::string_view finger;                ///< "" where it has no fingers
  std::array<std::string_view, 5> fingers;
  std::array<std::string_view, 3> segments;
};

[[nodiscard]] std::span<const RigNames> rigNames();

/// Bone names of a rig, written out for both sides; the bones that it lacks are not in it.
[[nodiscard]] std::map<HumanBone, std::string> namesOf(const RigNames& rig);

/// The mannequin's skeleton with these joints alone, so called, none marked as a bone.
[[nodiscard]] Skeleton renamedMannequin(const std::map<HumanBone, std::string>& names);

/// The names of the joints that a guess took for each bone.
[[nodiscard]] std::map<HumanBone, std::string> namesOf(const Skeleton& skeleton, const HumanoidGuess& guess);

/// What differs between the guess and the truth, a line each; empty when they agree.
[[nodiscard]] std::string differences(const std::map<HumanBone, std::string>& expected,
                                      const std::map<HumanBone, std::string>& found);

/// Whether each bone's joint hangs on that of the bone above, and no joint is two bones.
[[nodiscard]] std::string contradictions(const Skeleton& skeleton, const HumanoidGuess& guess);

}  // namespace lorica::test
