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

/// All shipped motions, retargeted to a character.
[[nodiscard]] std::vector<SkeletalMotion> syntheticMotions(const Character& character);

/// The matrices that skin a character in a pose.
[[nodiscard]] std::vector<Affine3> bonesOf(const Character& character, std::span<const JointTransform> pose);

/// Of the vertices of a body's hulls.
[[nodiscard]] std::uint64_t hashOfHulls(const LiveBody& body, std::uint64_t seed);

/// Decomposes the mannequin, trained on 12 keyframes of these motions.
[[nodiscard]] Result<Decomposition> decomposeMannequin(const Character& character, int parts);

/// The mannequin's body as in a session, and the bone transforms in the frames of the shipped walk.
struct Walker {
  std::unique_ptr<LiveBody> body;
  std::vector<std::vector<Affine3>> worldFromModel;
};

/// @param hullVertices  maximum per hull, see CoverSettings::maxHullVertices
[[nodiscard]] Result<Walker> makeWalker(int parts, int hullVertices);

}  // namespace lorica::bench
