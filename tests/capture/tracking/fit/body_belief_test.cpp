#include "capture/tracking/fit/body_belief.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lorica::fit {
namespace {

/// A fitted body of which some capsules are seen whole, the others not at all.
BodyBelief::Evidence evidence(float cost, int seen, bool moved = false, float height = 1.75F) {
  BodyBelief::Evidence result;
  result.cost.points = cost;
  std::fill_n(result.support.seen.begin(), seen, 1.0F);
  result.height = height;
  result.moved = moved;
  return result;
}

bool believedAfter(BodyBelief& belief, const BodyBelief::Evidence& evidence, int views) {
  for (int i = 0; i < views; ++i) belief.update(evidence);
  return belief.believed();
}

TEST(BodyBelief, OneViewThatFitsWellIsEnough) {
  BodyBelief belief;
  EXPECT_FALSE(belief.believed());
  EXPECT_TRUE(believedAfter(belief, evidence(900.0F, 19), 1));
  belief.forget();
  EXPECT_FALSE(belief.believed());
}

TEST(BodyBelief, FurnitureIsNeverBelieved) {
  // What chairs of the recordings got: a bad fit, or a better one of which half is not seen, or a giant.
  for (const auto& chair : {evidence(1380.0F, 18), evidence(1150.0F, 12), evidence(900.0F, 20, false, 2.2F)}) {
    BodyBelief belief;
    EXPECT_FALSE(believedAfter(belief, chair, 100));
  }
}

TEST(BodyBelief, WhoeverMovedNeedsLess) {
  BodyBelief still, moved;
  EXPECT_FALSE(believedAfter(still, evidence(1500.0F, 12), 30));
  EXPECT_FALSE(believedAfter(moved, evidence(1500.0F, 12, true), 2));
  EXPECT_TRUE(believedAfter(moved, evidence(1500.0F, 12, true), 1));
}

TEST(BodyBelief, LastsThroughAShortBadTimeOnly) {
  BodyBelief belief;
  ASSERT_TRUE(believedAfter(belief, evidence(900.0F, 19), 1));
  EXPECT_TRUE(believedAfter(belief, evidence(4000.0F, 3), 20));
  EXPECT_TRUE(believedAfter(belief, evidence(900.0F, 19), 30));
  EXPECT_TRUE(believedAfter(belief, evidence(4000.0F, 3), 20));
  EXPECT_FALSE(believedAfter(belief, evidence(4000.0F, 3), 10));
}

TEST(BodyBelief, WhatIsAttachedToTheRoomMustMoveAndBeSeen) {
  BodyBelief::Evidence seated = evidence(2100.0F, 16, true);
  BodyBelief free, attached;
  EXPECT_FALSE(believedAfter(free, seated, 30));
  seated.attached = true;
  EXPECT_TRUE(believedAfter(attached, seated, 3));
  seated.moved = false;
  attached.forget();
  EXPECT_FALSE(believedAfter(attached, seated, 30));
}

}  // namespace
}  // namespace lorica::fit
