#pragma once

#include "acd/decomposition.h"
#include "collision/live/live_body.h"
#include "geometry/math.h"
#include "geometry/result.h"
#include "skinning/character.h"
#include "skinning/clip.h"

#include <memory>
#include <vector>

namespace lorica::bench {

/// All that ship, on a character's bones.
[[nodiscard]] std::vector<SkeletalMotion> syntheticMotions(const Character& character);

/// The mannequin in parts, trained on 12 keyframes of them.
[[nodiscard]] Result<Decomposition> decomposeMannequin(const Character& character, int parts);

/// The mannequin's body as a session has it, and where the bones are in the frames of the shipped walk.
struct Walker {
  std::unique_ptr<LiveBody> body;
  std::vector<std::vector<Affine3>> worldFromModel;
};

/// @param hullVertices  most of a hull, see CoverSettings::maxHullVertices
[[nodiscard]] Result<Walker> makeWalker(int parts, int hullVertices);

}  // namespace lorica::bench
