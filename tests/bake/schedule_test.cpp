#include "bake/schedule.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

TEST(Schedule, EqualItemsFillEqualCores) {
  const std::vector<double> seconds(12, 2.0);
  const std::vector<std::size_t> order = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  const Schedule schedule = simulateSchedule(seconds, order, 4);
  EXPECT_DOUBLE_EQ(schedule.seconds, 6.0);
  EXPECT_DOUBLE_EQ(schedule.idleShare, 0.0);
  EXPECT_DOUBLE_EQ(schedule.tail, 2.0);
}

TEST(Schedule, AnItemThatStartsLastIsTheTail) {
  const std::vector<double> seconds = {1.0, 1.0, 1.0, 1.0, 10.0};
  const Schedule late = simulateSchedule(seconds, std::vector<std::size_t>{0, 1, 2, 3, 4}, 2);
  EXPECT_DOUBLE_EQ(late.seconds, 12.0);
  EXPECT_DOUBLE_EQ(late.tail, 10.0);
  EXPECT_DOUBLE_EQ(late.idleShare, 1.0 - 14.0 / 24.0);
  const Schedule early = simulateSchedule(seconds, std::vector<std::size_t>{4, 0, 1, 2, 3}, 2);
  EXPECT_DOUBLE_EQ(early.seconds, 10.0);
  EXPECT_DOUBLE_EQ(early.longest, 10.0);
}

TEST(Schedule, AShardThatHasMoreEndsLater) {
  const std::vector<double> seconds = {3.0, 1.0, 1.0};
  const Schedule schedule = simulateShards(seconds, std::vector<std::size_t>{0, 0, 1}, 2);
  EXPECT_DOUBLE_EQ(schedule.seconds, 4.0);
  EXPECT_DOUBLE_EQ(schedule.tail, 3.0);
  EXPECT_DOUBLE_EQ(schedule.idleShare, 1.0 - 5.0 / 8.0);
}

TEST(Schedule, DrawnItemsAreMeasuredOnes) {
  const std::vector<std::size_t> drawn = drawItems(7, 10'000);
  std::vector<int> counts(7, 0);
  for (const std::size_t item : drawn) ++counts.at(item);
  for (const int count : counts) EXPECT_NEAR(count, 10'000 / 7, 200);
  EXPECT_EQ(drawItems(7, 10'000), drawn);
}

}  // namespace
}  // namespace lorica::test
