#include "skinning/morphs/morphs.h"

#include "skinning/morphs/expressions.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace lorica {
namespace {

using Override = ExpressionOverride;

/// Random targets over `vertexCount` vertices, each of which moves about half of them.
[[nodiscard]] Morphs randomMorphs(std::mt19937& random, int targetCount, int vertexCount) {
  std::uniform_real_distribution<float> number(-1.0F, 1.0F);
  Morphs morphs;
  for (int t = 0; t < targetCount; ++t) {
    MorphTarget target;
    target.name = "target " + std::to_string(t);
    target.defaultWeight = t % 2 == 0 ? 0.0F : 0.25F;
    for (int v = 0; v < vertexCount; ++v) {
      if (number(random) > 0.0F) continue;
      target.offsets.push_back(
          {v, {number(random), number(random), number(random)}, {number(random), number(random), number(random)}});
    }
    morphs.targets.push_back(std::move(target));
  }
  return morphs;
}

TEST(Morphs, DefaultWeightsAreTheBindPose) {
  std::mt19937 random(1);
  const Morphs morphs = randomMorphs(random, 4, 10);
  const std::vector<Vec3> bind(10, Vec3(1.0, 2.0, 3.0));
  const std::vector<Vec3f> bindNormals(10, Vec3f::UnitY());
  std::vector<Vec3> positions(10);
  std::vector<Vec3f> normals(10);
  std::vector<float> weights(4);
  std::ranges::transform(morphs.targets, weights.begin(), &MorphTarget::defaultWeight);
  applyMorphs(morphs, weights, bind, bindNormals, positions, normals);
  EXPECT_EQ(positions, bind);
  EXPECT_EQ(normals, bindNormals);
}

TEST(Morphs, SparseTargetsGiveWhatDenseOnesDo) {
  constexpr int kVertices = 50;
  constexpr int kTargets = 6;
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> number(-1.0F, 1.5F);
    const Morphs morphs = randomMorphs(random, kTargets, kVertices);
    std::vector<Vec3> bind;
    std::vector<Vec3f> bindNormals;
    for (int v = 0; v < kVertices; ++v) {
      bind.emplace_back(number(random), number(random), number(random));
      bindNormals.push_back(Vec3f(number(random), number(random), 2.0F).normalized());
    }
    std::vector<float> weights;
    for (int t = 0; t < kTargets; ++t) weights.push_back(t == 3 ? 0.25F : number(random));

    std::vector<Vec3> positions(kVertices);
    std::vector<Vec3f> normals(kVertices);
    applyMorphs(morphs, weights, bind, bindNormals, positions, normals);

    for (int v = 0; v < kVertices; ++v) {
      Vec3 position = bind[v];
      Vec3 normal = bindNormals[v].cast<double>();
      for (int t = 0; t < kTargets; ++t) {
        const double factor = static_cast<double>(weights[t]) - morphs.targets[t].defaultWeight;
        for (const MorphOffset& offset : morphs.targets[t].offsets) {
          if (offset.vertex != v) continue;
          position += factor * offset.position.cast<double>();
          normal += factor * offset.normal.cast<double>();
        }
      }
      EXPECT_LT((positions[v] - position).norm(), 1e-6);
      EXPECT_LT((normals[v].cast<double>() - normal.normalized()).norm(), 1e-4);
    }
  }
}

TEST(Morphs, MeshesWithoutNormalsAreMovedToo) {
  std::mt19937 random(3);
  const Morphs morphs = randomMorphs(random, 1, 4);
  const std::vector<Vec3> bind(4, Vec3::Zero());
  std::vector<Vec3> positions(4);
  const std::vector<float> weights = {1.0F};
  applyMorphs(morphs, weights, bind, {}, positions, {});
  for (const MorphOffset& offset : morphs.targets[0].offsets) {
    EXPECT_EQ(positions[offset.vertex], offset.position.cast<double>());
  }
}

TEST(Morphs, TracksAreInterpolatedAsGltfDefines) {
  MorphWeightTrack track{1, 2, KeyInterpolation::kLinear, {1.0, 3.0}, {0.0F, 1.0F, 1.0F, 0.5F}};
  const auto at = [&](double time) {
    std::vector<float> weights = {9.0F, 9.0F, 9.0F};
    sampleMorphWeights(std::span(&track, 1), time, weights);
    EXPECT_EQ(weights[0], 9.0F);  // it has no track
    return std::pair(weights[1], weights[2]);
  };
  EXPECT_EQ(at(-5.0), std::pair(0.0F, 1.0F));
  EXPECT_EQ(at(2.0), std::pair(0.5F, 0.75F));
  EXPECT_EQ(at(99.0), std::pair(1.0F, 0.5F));
  track.interpolation = KeyInterpolation::kStep;
  EXPECT_EQ(at(2.9), std::pair(0.0F, 1.0F));
  EXPECT_EQ(at(3.0), std::pair(1.0F, 0.5F));

  // The cubic 2 t^3 - t + 1 of the time since the first key, with its slopes as tangents; the second target is
  // constant.
  track.interpolation = KeyInterpolation::kCubicSpline;
  const auto cubic = [](double s) { return 2.0 * s * s * s - s + 1.0; };
  const auto slope = [](double s) { return 6.0 * s * s - 1.0; };
  track.values.clear();
  for (const double s : {0.0, 2.0}) {
    const auto m = static_cast<float>(slope(s));
    track.values.insert(track.values.end(), {m, 0.0F, static_cast<float>(cubic(s)), 0.5F, m, 0.0F});
  }
  for (const double time : {1.0, 1.3, 2.0, 2.71, 3.0}) {
    EXPECT_NEAR(at(time).first, cubic(time - 1.0), 1e-5);
    EXPECT_NEAR(at(time).second, 0.5, 1e-6);
  }
}

TEST(Morphs, AFrameAllocatesNothing) {
  std::mt19937 random(5);
  const Morphs morphs = randomMorphs(random, 3, 100);
  const std::vector<Vec3> bind(100, Vec3::Zero());
  const std::vector<Vec3f> bindNormals(100, Vec3f::UnitX());
  std::vector<Vec3> positions(100);
  std::vector<Vec3f> normals(100);
  std::vector<float> weights(3);
  const MorphWeightTrack track{0, 3, KeyInterpolation::kLinear, {0.0, 1.0}, {0, 0, 0, 1, 1, 1}};
  const long before = test::allocationCount();
  ASSERT_GT(before, 0);
  std::ranges::transform(morphs.targets, weights.begin(), &MorphTarget::defaultWeight);
  sampleMorphWeights(std::span(&track, 1), 0.5, weights);
  applyMorphs(morphs, weights, bind, bindNormals, positions, normals);
  EXPECT_EQ(test::allocationCount() - before, 0);
}

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

[[nodiscard]] Expression named(const std::string& name, bool binary = false) {
  Expression expression;
  expression.name = name;
  expression.binary = binary;
  return expression;
}

/// Effective weights of expressions for given weights.
[[nodiscard]] std::vector<float> effectiveOf(const Expressions& expressions, const std::vector<float>& weights) {
  std::vector<float> effective(weights.size());
  effectiveWeights(expressions, weights, effective);
  return effective;
}

TEST(Expressions, BothSpellingsInAnyCaseFindAPreset) {
  Expressions expressions;
  for (const char* name : {"happy", "blinkLeft", "aa", "lookUp", "Wink Special"}) {
    ASSERT_TRUE(addExpression(expressions, named(name)));
  }
  for (const char* name : {"happy", "Happy", "joy", "JOY"}) EXPECT_EQ(findExpression(expressions, name), 0u) << name;
  for (const char* name : {"blinkleft", "Blink_L"}) EXPECT_EQ(findExpression(expressions, name), 1u) << name;
  for (const char* name : {"A", "AA"}) EXPECT_EQ(findExpression(expressions, name), 2u) << name;
  for (const char* name : {"LookUp", "lookup"}) EXPECT_EQ(findExpression(expressions, name), 3u) << name;
  EXPECT_EQ(findExpression(expressions, "wink special"), 4u);
  EXPECT_FALSE(findExpression(expressions, "wink"));
  EXPECT_FALSE(findExpression(expressions, "sorrow"));
  EXPECT_FALSE(findExpression(expressions, ""));
  EXPECT_EQ(namesOf(expressions), "happy, blinkLeft, aa, lookUp, Wink Special");
}

TEST(Expressions, AnOwnNameIsPreferredToAPresetsOtherName) {
  Expressions expressions;
  ASSERT_TRUE(addExpression(expressions, named("happy")));
  ASSERT_TRUE(addExpression(expressions, named("Joy")));
  EXPECT_EQ(findExpression(expressions, "joy"), 1u);
}

TEST(Expressions, ANameIsTakenOnce) {
  Expressions expressions;
  EXPECT_TRUE(addExpression(expressions, named("Smile")));
  EXPECT_FALSE(addExpression(expressions, named("smile")));
  EXPECT_EQ(expressions.list.size(), 1u);
}

TEST(Expressions, PresetsHaveOldNames) {
  EXPECT_EQ(nameInVrm0("happy"), "Joy");
  EXPECT_EQ(nameInVrm0("blinkLeft"), "Blink_L");
  EXPECT_EQ(nameInVrm0("aa"), "A");
  EXPECT_EQ(nameInVrm0("surprised"), "surprised");
  EXPECT_EQ(nameInVrm0("MyFace"), "MyFace");
}

TEST(Expressions, NamesOfPresetsIn0AreThoseOf1) {
  EXPECT_EQ(presetName("Joy"), "happy");
  EXPECT_EQ(presetName("fun"), "relaxed");
  EXPECT_EQ(presetName("sorrow"), "sad");
  EXPECT_EQ(presetName("a"), "aa");
  EXPECT_EQ(presetName("i"), "ih");
  EXPECT_EQ(presetName("u"), "ou");
  EXPECT_EQ(presetName("e"), "ee");
  EXPECT_EQ(presetName("o"), "oh");
  EXPECT_EQ(presetName("blink_l"), "blinkLeft");
  EXPECT_EQ(presetName("blink_r"), "blinkRight");
  EXPECT_EQ(presetName("lookdown"), "lookDown");
  EXPECT_EQ(presetName("Cheeks"), "Cheeks");
}

TEST(Expressions, WeightsAreClampedAndBinaryOnesRounded) {
  Expressions expressions;
  addExpression(expressions, named("happy"));
  addExpression(expressions, named("angry", true));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(effectiveOf(expressions, {0.3F, 0.5F}), (std::vector<float>{0.3F, 0.0F}));
  EXPECT_EQ(effectiveOf(expressions, {1.5F, 0.51F}), (std::vector<float>{1.0F, 1.0F}));
  EXPECT_EQ(effectiveOf(expressions, {-1.0F, -1.0F}), (std::vector<float>{0.0F, 0.0F}));
  EXPECT_EQ(effectiveOf(expressions, {nan, nan}), (std::vector<float>{0.0F, 0.0F}));
}

/// Every mix of who overrides how, with what weight, and whether either is binary, against the specification's rules
/// said another way.
TEST(Expressions, OverridesFollowTheSpecification) {
  for (const Override how : {Override::kNone, Override::kBlock, Override::kBlend}) {
    for (const bool overriderBinary : {false, true}) {
      for (const bool overriddenBinary : {false, true}) {
        for (const float weight : {0.0F, 0.25F, 0.5F, 0.75F, 1.0F}) {
          for (const ProceduralKind kind : {ProceduralKind::kBlink, ProceduralKind::kLookAt, ProceduralKind::kMouth}) {
            Expressions expressions;
            Expression happy = named("happy", overriderBinary);
            (kind == ProceduralKind::kBlink    ? happy.overrideBlink
             : kind == ProceduralKind::kLookAt ? happy.overrideLookAt
                                               : happy.overrideMouth) = how;
            addExpression(expressions, happy);
            addExpression(expressions, named("blinkRight", overriddenBinary));
            addExpression(expressions, named("lookDown", overriddenBinary));
            addExpression(expressions, named("ou", overriddenBinary));
            addExpression(expressions, named("sad", overriddenBinary));
            const std::vector<float> effective = effectiveOf(expressions, {weight, 0.8F, 0.8F, 0.8F, 0.8F});

            const float shown = overriderBinary ? (weight > 0.5F ? 1.0F : 0.0F) : weight;
            const float alone = overriddenBinary ? 1.0F : 0.8F;
            float left = 1.0F;
            if (shown > 0.0F && how == Override::kBlock) left = 0.0F;
            if (shown > 0.0F && how == Override::kBlend) left = overriddenBinary ? 0.0F : 1.0F - shown;
            EXPECT_EQ(effective[0], shown);
            EXPECT_FLOAT_EQ(effective[1], alone * (kind == ProceduralKind::kBlink ? left : 1.0F));
            EXPECT_FLOAT_EQ(effective[2], alone * (kind == ProceduralKind::kLookAt ? left : 1.0F));
            EXPECT_FLOAT_EQ(effective[3], alone * (kind == ProceduralKind::kMouth ? left : 1.0F));
            EXPECT_FLOAT_EQ(effective[4], alone);
          }
        }
      }
    }
  }
}

TEST(Expressions, OverridesAddUpToAllOfIt) {
  Expressions expressions;
  for (const char* name : {"happy", "sad"}) {
    Expression expression = named(name);
    expression.overrideMouth = Override::kBlend;
    addExpression(expressions, expression);
  }
  addExpression(expressions, named("aa"));
  EXPECT_NEAR(effectiveOf(expressions, {0.3F, 0.3F, 1.0F})[2], 0.4F, 1e-6);
  EXPECT_EQ(effectiveOf(expressions, {0.7F, 0.7F, 1.0F})[2], 0.0F);
}

TEST(Expressions, AnExpressionDoesNotOverrideItsOwnKind) {
  Expressions expressions;
  Expression blink = named("blink");
  blink.overrideBlink = Override::kBlock;
  blink.overrideLookAt = Override::kBlock;
  addExpression(expressions, blink);
  addExpression(expressions, named("lookUp"));
  EXPECT_EQ(effectiveOf(expressions, {1.0F, 1.0F}), (std::vector<float>{1.0F, 0.0F}));
}

TEST(Expressions, TargetsAreSumsUponTheBaseWeights) {
  Expressions expressions;
  Expression happy = named("happy");
  happy.morphs = {{0, 0.5F}, {2, 1.0F}};
  Expression angry = named("angry");
  angry.morphs = {{2, 0.75F}};
  addExpression(expressions, happy);
  addExpression(expressions, angry);
  expressions.baseWeights = {0.0F, 0.25F, 0.0F};
  std::vector<float> targets = expressions.baseWeights;
  addMorphWeights(expressions, std::vector<float>{0.5F, 1.0F}, targets);
  EXPECT_EQ(targets, (std::vector<float>{0.25F, 0.25F, 1.25F}));
  addMorphWeights(expressions, std::vector<float>{1.0F, 0.0F}, targets);
  EXPECT_EQ(targets, (std::vector<float>{0.75F, 0.25F, 2.25F}));
}

TEST(Expressions, AFrameAllocatesNothing) {
  Expressions expressions;
  Expression happy = named("happy");
  happy.morphs = {{0, 1.0F}};
  addExpression(expressions, happy);
  expressions.baseWeights = {0.0F};
  const std::vector<float> weights = {1.0F};
  std::vector<float> effective(1);
  std::vector<float> targets(1);
  const long before = test::allocationCount();
  ASSERT_GT(before, 0);
  effectiveWeights(expressions, weights, effective);
  addMorphWeights(expressions, effective, targets);
  EXPECT_EQ(test::allocationCount() - before, 0);
}

}  // namespace
}  // namespace lorica
