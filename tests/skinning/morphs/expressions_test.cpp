#include "skinning/morphs/expressions.h"

#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lorica {
namespace {

using Override = ExpressionOverride;

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
