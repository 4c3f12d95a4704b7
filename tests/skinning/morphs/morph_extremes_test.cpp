#include "skinning/morphs/morph_extremes.h"

#include <gtest/gtest.h>

#include <random>

namespace lorica {
namespace {

TEST(MorphExtremes, NothingUsedReachesNothing) {
  Morphs morphs;
  const std::vector<Vec3> bind(3, Vec3::Zero());
  EXPECT_TRUE(reachedPositions(morphs, {}, bind, 0.002).empty());
  morphs.targets.push_back({"belly", 0.5F, {{1, {0.0F, 0.0F, 0.1F}, Vec3f::Zero()}}});
  EXPECT_TRUE(reachedPositions(morphs, std::vector<float>{0.5F}, bind, 0.002).empty());
}

TEST(MorphExtremes, SmallMotionsAreLeftOut) {
  Morphs morphs;
  morphs.targets.push_back({"belly", 0.0F, {{0, {0, 0, 0.1F}, Vec3f::Zero()}, {2, {0, 0.001F, 0}, Vec3f::Zero()}}});
  const std::vector<Vec3> bind(3, Vec3(1.0, 1.0, 1.0));
  const std::vector<ReachedPosition> reached = reachedPositions(morphs, std::vector<float>{1.0F}, bind, 0.002);
  ASSERT_EQ(reached.size(), 1u);
  EXPECT_EQ(reached[0].vertex, 0);
  EXPECT_LT((reached[0].position - Vec3(1.0, 1.0, 1.1)).norm(), 1e-7);
}

TEST(MorphExtremes, OneTargetHasTwoEnds) {
  Morphs morphs;
  morphs.targets.push_back({"belly", 0.25F, {{0, {0.1F, 0.03F, 0.02F}, Vec3f::Zero()}}});
  const std::vector<Vec3> bind(1, Vec3::Zero());
  std::vector<float> keys;
  for (int i = 0; i <= 20; ++i) keys.push_back(-0.5F + 0.1F * static_cast<float>(i));
  const std::vector<ReachedPosition> reached = reachedPositions(morphs, keys, bind, 0.002);
  ASSERT_EQ(reached.size(), 2u);
  const Vec3 offset = Vec3f(0.1F, 0.03F, 0.02F).cast<double>();
  double low = 0.0;
  double high = 0.0;
  for (const ReachedPosition& r : reached) {
    low = std::min(low, r.position.dot(offset) / offset.squaredNorm());
    high = std::max(high, r.position.dot(offset) / offset.squaredNorm());
  }
  EXPECT_NEAR(low, -0.75, 1e-6);
  EXPECT_NEAR(high, 1.25, 1e-6);
}

/// How far positions lie outside of the kept ones, as their support along many directions tells.
TEST(MorphExtremes, SeveralTargetsAreHeldToAShareOfTheWay) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> number(-0.1F, 0.1F);
  std::uniform_real_distribution<float> weight(0.0F, 1.0F);
  std::normal_distribution<double> normal;
  double worst = 0.0;
  for (int trial = 0; trial < 20; ++trial) {
    Morphs morphs;
    for (int t = 0; t < 5; ++t) {
      morphs.targets.push_back({"t", 0.0F, {{0, {number(random), number(random), number(random)}, Vec3f::Zero()}}});
    }
    std::vector<float> sets;
    for (int i = 0; i < 5 * 300; ++i) sets.push_back(weight(random));
    const std::vector<Vec3> bind(1, Vec3::Zero());
    const std::vector<ReachedPosition> reached = reachedPositions(morphs, sets, bind, 0.002);
    std::vector<Vec3> all;
    double way = 0.0;
    for (std::size_t s = 0; s < 300; ++s) {
      Vec3 p = Vec3::Zero();
      for (std::size_t t = 0; t < 5; ++t) {
        p += static_cast<double>(sets[5 * s + t]) * morphs.targets[t].offsets[0].position.cast<double>();
      }
      all.push_back(p);
      way = std::max(way, p.norm());
    }
    for (int d = 0; d < 300; ++d) {
      const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
      double kept = 0.0;
      double needed = 0.0;
      for (const ReachedPosition& r : reached) kept = std::max(kept, r.position.dot(direction));
      for (const Vec3& p : all) needed = std::max(needed, p.dot(direction));
      worst = std::max(worst, (needed - kept) / way);
    }
  }
  EXPECT_LT(worst, 0.15);
}

/// Targets 0 to 2: happy, blink, and one of a clip.
TEST(MorphExtremes, UsedWeightsAreTheChosenOnesAndTheKeysOfClips) {
  Morphs morphs;
  Expressions expressions;
  for (int t = 0; t < 3; ++t) {
    morphs.targets.push_back({"t", 0.0F, {}});
    expressions.baseWeights.push_back(0.0F);
  }
  for (const auto& [name, target] : {std::pair("happy", 0), std::pair("blink", 1), std::pair("aa", 2)}) {
    Expression expression;
    expression.name = name;
    expression.morphs = {{target, 1.0F}};
    addExpression(expressions, expression);
  }
  const std::vector<float> chosen = {0.5F, 0.0F, 0.0F};
  EXPECT_EQ(usedWeightSets(morphs, expressions, chosen), (std::vector<float>{0.5F, 0, 0}));
  morphs.clips = {{}, {{2, 1, KeyInterpolation::kLinear, {0.0, 2.0}, {0.25F, 0.75F}}}};
  EXPECT_EQ(usedWeightSets(morphs, expressions, chosen),
            (std::vector<float>{0.5F, 0, 0, 0.5F, 0, 0.25F, 0.5F, 0, 0.75F}));
}

TEST(MorphExtremes, UsedWeightsOfManyLongClipsAreBounded) {
  Morphs morphs;
  Expressions expressions;
  morphs.targets.push_back({"t", 0.0F, {}});
  expressions.baseWeights = {0.0F};
  MorphWeightTrack track{0, 1, KeyInterpolation::kLinear, {}, {}};
  for (int key = 0; key < 5000; ++key) {
    track.times.push_back(0.1 * key);
    track.values.push_back(key % 2 == 0 ? 0.0F : 1.0F);
  }
  morphs.clips.assign(3, {track});
  EXPECT_EQ(usedWeightSets(morphs, expressions, {}).size(), 1u + 3u * 512u);
  morphs.clips.assign(20'000, {track});
  EXPECT_EQ(usedWeightSets(morphs, expressions, {}).size(), 4096u);
}

}  // namespace
}  // namespace lorica
