#pragma once

#include "acd/decomposition.h"
#include "skinning/character.h"
#include "skinning/clip.h"
#include "skinning/springs/spring_bones.h"

#include <functional>

/// A character small enough to think about: a body of one box with a strand of hair next to it.
namespace lorica::test {

/// Joint 0 moves the body, a box of 0.4 x 1 x 0.4 m about the height 1 m. Joints 1 to 3 move the hair, a thin box that
/// hangs at its side from (0.25, 1.4, 0) down to 0.8, a third each.
[[nodiscard]] Character hairedBox();

/// Part 0 is the body, part 1 the hair.
[[nodiscard]] Decomposition hairedBoxParts();

/// The three joints swing; `like` gives their settings.
[[nodiscard]] SpringBones hairedBoxSprings(const SpringJoint& like);

/// A motion of the character at 60 frames/s in which joint 0 is placed and everything else rests.
[[nodiscard]] SkeletalMotion hairedBoxMotion(int frames, const std::function<JointTransform(double time)>& place);

}  // namespace lorica::test
