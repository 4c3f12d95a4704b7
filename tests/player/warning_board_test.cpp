#include "player/warning_board.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

TEST(WarningBoard, HoldsWhatComesAndGoesForASecond) {
  WarningBoard board;
  board.raise("limbs", "left hand lost", 10.0);
  board.update(10.0);
  ASSERT_EQ(board.sentences().size(), 1u);
  board.update(10.9);
  EXPECT_EQ(board.sentences().size(), 1u);
  // Raised in every other frame: it is shown all the time.
  for (int frame = 0; frame < 90; ++frame) {
    const double now = 10.0 + frame / 30.0;
    if (frame % 2 == 0) board.raise("limbs", "left hand lost", now);
    board.update(now);
    ASSERT_EQ(board.sentences().size(), 1u);
  }
  board.update(14.1);
  EXPECT_TRUE(board.sentences().empty());
}

TEST(WarningBoard, WhatComesBackIsHeldLonger) {
  WarningBoard board;
  // Every 3 s for a moment: after a few times it stays, instead of coming and going.
  std::vector<bool> shown;
  for (int tick = 0; tick < 600; ++tick) {
    const double now = 0.1 * tick;
    if (tick % 30 == 0) board.raise("limbs", "left hand lost", now);
    board.update(now);
    shown.push_back(!board.sentences().empty());
  }
  const auto changes = std::adjacent_find(shown.begin() + 80, shown.end(), std::not_equal_to<>());
  EXPECT_EQ(changes, shown.end());
  EXPECT_TRUE(shown.back());
  board.update(59.7 - 2.7 + WarningBoard::kLongestHold);
  EXPECT_TRUE(board.sentences().empty());
  // Later it is new.
  board.raise("limbs", "left hand lost", 100.0);
  board.update(100.0 + WarningBoard::kHoldSeconds);
  EXPECT_TRUE(board.sentences().empty());
}

TEST(WarningBoard, WordsChangeOncePerSecondAtMostAndKindsKeepTheirOrder) {
  WarningBoard board;
  board.raise("limbs", "a", 0.0);
  board.raise("training", "t", 0.1);
  board.raise("limbs", "b", 0.5);
  ASSERT_EQ(board.sentences().size(), 2u);
  EXPECT_EQ(board.sentences()[0], "a") << "too soon to be read";
  board.raise("limbs", "b", 1.0);
  EXPECT_EQ(board.sentences()[0], "b");
  EXPECT_EQ(board.sentences()[1], "t");
  board.update(1.2);
  ASSERT_EQ(board.sentences().size(), 1u);
  EXPECT_EQ(board.sentences()[0], "b");
}

}  // namespace
}  // namespace lorica
