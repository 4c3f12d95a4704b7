#include "tests/bench/walker.h"

#include "acd/decompose.h"
#include "capture/files/joint_csv.h"
#include "capture/retarget/retarget.h"
#include "collision/hulls/cover_choice.h"
#include "collision/hulls/keyframes.h"
#include "collision/live/choose_cover.h"
#include "session/pose_source.h"
#include "session/prepare/training_motions.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"

#include <xxhash.h>

namespace lorica::bench {

std::vector<SkeletalMotion> syntheticMotions(const Character& character) {
  std::vector<SkeletalMotion> motions;
  motions.reserve(kShippedMotions.size());
  for (const std::string_view name : kShippedMotions) {
    motions.push_back(perform(character.skeleton, shippedFrames(name)).value());
  }
  return motions;
}

std::vector<Affine3> bonesOf(const Character& character, std::span<const JointTransform> pose) {
  std::vector<Affine3> matrices(pose.size());
  computeWorldFromJoint(character.skeleton, pose, matrices);
  computeWorldFromModel(character, matrices, matrices);
  return matrices;
}

std::uint64_t hashOfHulls(const LiveBody& body, std::uint64_t seed) {
  for (const LivePart& part : body.parts()) {
    seed = XXH3_64bits_withSeed(part.shape.vertices.data(), part.shape.vertices.size() * sizeof(Vec3), seed);
  }
  return seed;
}

Result<Decomposition> decomposeMannequin(const Character& character, int parts) {
  const Result<std::vector<Vec3>> keyframes = sampleKeyframes(character, syntheticMotions(character), 12);
  if (!keyframes) return keyframes.error();
  const PoseView poses{*keyframes, static_cast<int>(character.mesh.vertices.size())};
  return decompose(character.mesh, poses, {.maxParts = parts});
}

Result<Walker> makeWalker(int parts, int hullVertices) {
  const Character character = makeMannequin();
  Result<Decomposition> decomposition = decomposeMannequin(character, parts);
  if (!decomposition) return decomposition.error();

  Walker walker;
  const Result<CoverPoses> coverIn = coverPoses(character, syntheticMotions(character));
  if (!coverIn) return coverIn.error();
  const std::vector<LiftedPoint> points = liftPoints(character, *decomposition);
  Result<HullCover> cover =
      chooseCover(*decomposition, points, coverIn->sampledView(), {}, {.maxHullVertices = hullVertices});
  if (!cover) return cover.error();
  walker.body =
      std::make_unique<LiveBody>(LiveBody::create(std::move(*decomposition), character, std::move(*cover)).value());
  Result<Retargeter> retargeter = Retargeter::create(character.skeleton);
  if (!retargeter) return retargeter.error();
  Pose pose = restPose(character.skeleton);
  for (const SkeletonFrame& frame : shippedFrames("walk")) {
    retargeter->apply(frame, pose);
    walker.worldFromModel.push_back(bonesOf(character, pose));
  }
  return walker;
}

}  // namespace lorica::bench
