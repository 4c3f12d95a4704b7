// Extends Thul et al. 2018, Fig. 9: a decomposition trained on several poses fits an unseen motion better than one
// trained on a single pose.

#include "acd/decompose.h"
#include "acd/transfer.h"
#include "capture/synthetic/synthetic_motion.h"
#include "prepare/keyframes.h"
#include "session/pose_source.h"
#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace lorica {
namespace {

struct Spread {
  double mean = 0.0;
  double deviation = 0.0;
};

/// Relative volume error of a decomposition over every `stride`-th frame of posed positions.
Spread errorOver(const Decomposition& decomposition, const TriMesh& mesh, PoseView poses, int stride) {
  double sum = 0.0, sumSq = 0.0;
  int count = 0;
  for (int k = 0; k < poses.keyframeCount(); k += stride, ++count) {
    const double e = errorInPose(decomposition, mesh, poses.keyframe(k)).relative();
    sum += e;
    sumSq += e * e;
  }
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, sumSq / count - mean * mean))};
}

Decomposition sixteenParts(const TriMesh& mesh, std::span<const Vec3> keyframes) {
  const PoseView poses{keyframes, static_cast<int>(mesh.vertices.size())};
  Result<Decomposition> made = decompose(mesh, poses, {.maxParts = 16});
  LORICA_CHECK(made.ok(), "the mannequin is a closed two-manifold");
  LORICA_CHECK(made->parts.size() == 16, "a body has more than 16 concave regions");
  return std::move(made).value();
}

TEST(UnseenMotion, TwelveKeyframesFollowAMotionThatTheyNeverSawBetterThanTheFirstFrameAlone) {
  // Each motion in turn is held out. The other five train two decompositions with default settings: one with twelve
  // frames at even intervals, one with only the first of these frames.
  const Character character = makeMannequin();
  std::vector<SkeletalMotion> motions;
  for (int m = 0; m < kSyntheticMotionCount; ++m) {
    motions.push_back(perform(character.skeleton, synthesizeMotion(static_cast<SyntheticMotion>(m))).value());
  }

  double meanOfTwelve = 0.0, meanOfFirst = 0.0;
  for (int unseen = 0; unseen < kSyntheticMotionCount; ++unseen) {
    std::vector<SkeletalMotion> training = motions;
    training.erase(training.begin() + unseen);
    const Result<std::vector<Vec3>> keyframes = sampleKeyframes(character, training, 12);
    const std::vector<Vec3> posed = poseAllFrames(character, motions[unseen]);
    ASSERT_TRUE(keyframes.ok());
    const PoseView poses{posed, static_cast<int>(character.mesh.vertices.size())};
    const Spread twelve = errorOver(sixteenParts(character.mesh, *keyframes), character.mesh, poses, 10);
    const std::span<const Vec3> firstFrame = std::span(*keyframes).first(character.mesh.vertices.size());
    const Spread first = errorOver(sixteenParts(character.mesh, firstFrame), character.mesh, poses, 10);
    std::cout << nameOf(static_cast<SyntheticMotion>(unseen))
              << " unseen, 16 parts, relative volume error: 12 keyframes " << twelve.mean << " +- " << twelve.deviation
              << ", first frame only " << first.mean << " +- " << first.deviation << '\n';
    EXPECT_GT(twelve.mean, 0.0) << "hulls cover the surface";
    meanOfTwelve += twelve.mean / kSyntheticMotionCount;
    meanOfFirst += first.mean / kSyntheticMotionCount;
  }
  std::cout << "mean: 12 keyframes " << meanOfTwelve << ", first frame only " << meanOfFirst << '\n';
  RecordProperty("meanErrorTwelveKeyframes", std::to_string(meanOfTwelve));
  RecordProperty("meanErrorFirstFrame", std::to_string(meanOfFirst));
  EXPECT_LT(meanOfTwelve, meanOfFirst);
}

}  // namespace
}  // namespace lorica
