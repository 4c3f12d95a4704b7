#include "skinning/morphs/face.h"

#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lorica {
namespace {

TEST(Blink, ComesEveryTwoToSixSecondsForATenthToAFifthOfASecond) {
  for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1}, ~std::uint64_t{0}}) {
    constexpr double kStep = 0.0005;
    std::vector<double> begins;
    std::vector<double> lengths;
    double shortest = 1.0;
    float closest = 1.0F;  // the least that any blink closes the eyes
    float peak = 0.0F;
    bool closed = false;
    for (int i = 0; i < 2'000'000; ++i) {
      const double time = i * kStep;
      const float weight = blinkWeight(time, seed);
      ASSERT_GE(weight, 0.0F);
      ASSERT_LE(weight, 1.0F);
      if (weight > 0.0F && !closed) begins.push_back(time);
      if (weight == 0.0F && closed) {
        lengths.push_back(time - begins.back());
        shortest = std::min(shortest, lengths.back());
        closest = std::min(closest, peak);
        peak = 0.0F;
      }
      closed = weight > 0.0F;
      peak = std::max(peak, weight);
    }
    ASSERT_GT(begins.size(), 200u);
    EXPECT_GE(begins.front(), 2.0);
    for (std::size_t b = 1; b < begins.size(); ++b) {
      EXPECT_GE(begins[b] - begins[b - 1], 2.0 - kStep);
      EXPECT_LE(begins[b] - begins[b - 1], 6.0 + kStep);
    }
    for (const double length : lengths) {
      EXPECT_GE(length, 0.1 - 2.0 * kStep);
      EXPECT_LE(length, 0.2 + 2.0 * kStep);
    }
    EXPECT_GT(*std::max_element(lengths.begin(), lengths.end()) - shortest, 0.05);
    EXPECT_GT(closest, 0.99F);
  }
}

TEST(Blink, DependsOnTimeAndSeedAlone) {
  EXPECT_EQ(blinkWeight(0.0), 0.0F);  // faces begin with open eyes
  EXPECT_EQ(blinkWeight(std::numeric_limits<double>::quiet_NaN()), 0.0F);
  EXPECT_EQ(blinkWeight(kInfinity), 0.0F);
  int differ = 0;
  for (int i = 0; i < 10000; ++i) {
    const double time = 0.02 * i;
    EXPECT_EQ(blinkWeight(time, 7), blinkWeight(time, 7));
    differ += blinkWeight(time, 7) != blinkWeight(time, 8) ? 1 : 0;
  }
  EXPECT_GT(differ, 100);
}

/// Targets 0 blink, 1 left, 2 up, 3 happy, 4 of a clip.
class FaceTest : public testing::Test {
 protected:
  FaceTest() {
    const char* names[] = {"blink", "lookLeft", "lookUp", "happy"};
    for (int t = 0; t < 5; ++t) {
      morphs.targets.push_back({"target", 0.0F, {}});
      expressions.baseWeights.push_back(0.0F);
      if (t == 4) continue;
      Expression expression;
      expression.name = names[t];
      expression.morphs = {{t, 1.0F}};
      if (t == 3) expression.overrideBlink = ExpressionOverride::kBlock;
      addExpression(expressions, expression);
    }
    lookAt.kind = LookAtKind::kExpression;
    for (LookAtRange* range : {&lookAt.outer, &lookAt.up, &lookAt.down}) *range = {1.0, 0.8};
    while (blinkWeight(blinkTime) < 0.5F) blinkTime += 0.001;
  }

  Morphs morphs;
  Expressions expressions;
  LookAt lookAt;
  double blinkTime = 0.0;
};

TEST_F(FaceTest, BlinksAndLooksWhenNothingDrivesIt) {
  Face face(morphs, expressions, lookAt);
  face.update({blinkTime, {0.5, -2.0}});
  EXPECT_EQ(face.targetWeights()[0], blinkWeight(blinkTime));
  EXPECT_FLOAT_EQ(face.targetWeights()[1], 0.4F);
  EXPECT_FLOAT_EQ(face.targetWeights()[2], 0.8F);
  EXPECT_EQ(face.targetWeights()[3], 0.0F);
  face.setBlinking(false);
  face.update({blinkTime, {}});
  for (const float weight : face.targetWeights()) EXPECT_EQ(weight, 0.0F);
}

TEST_F(FaceTest, ChosenWeightsStayAndOverride) {
  Face face(morphs, expressions, lookAt);
  face.set(3, 0.6F);
  face.set(1, 0.1F);
  face.update({blinkTime, {0.5, -0.5}});
  EXPECT_EQ(face.targetWeights()[0], 0.0F);  // blocked
  EXPECT_EQ(face.targetWeights()[1], 0.1F);  // chosen: the gaze is ignored
  EXPECT_EQ(face.targetWeights()[2], 0.0F);
  EXPECT_EQ(face.targetWeights()[3], 0.6F);
  EXPECT_EQ(face.expressionWeights()[3], 0.6F);
  face.set(3, 0.0F);
  face.set(0, 0.2F);
  face.update({blinkTime, {}});
  EXPECT_EQ(face.targetWeights()[0], 0.2F);
}

TEST_F(FaceTest, AClipSetsTargetsAndExpressionsAddToThem) {
  Face face(morphs, expressions, lookAt);
  const MorphWeightTrack track{3, 2, KeyInterpolation::kLinear, {0.0, 1.0}, {0.0F, 0.0F, 0.5F, 1.0F}};
  face.set(3, 0.25F);
  face.update({blinkTime, {}, std::span(&track, 1), 0.5});
  EXPECT_EQ(face.targetWeights()[0], 0.0F);
  EXPECT_EQ(face.targetWeights()[3], 0.5F);
  EXPECT_EQ(face.targetWeights()[4], 0.5F);
}

TEST_F(FaceTest, AFrameAllocatesNothing) {
  Face face(morphs, expressions, lookAt);
  const MorphWeightTrack track{3, 2, KeyInterpolation::kLinear, {0.0, 1.0}, {0.0F, 0.0F, 0.5F, 1.0F}};
  const long before = test::allocationCount();
  ASSERT_GT(before, 0);
  face.update({blinkTime, {0.1, 0.1}});
  face.update({blinkTime, {}, std::span(&track, 1), 0.5});
  EXPECT_EQ(test::allocationCount() - before, 0);
}

}  // namespace
}  // namespace lorica
