#include "bake/schedule.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

struct ScheduleRow {
  const char* what;
  bool shards;  ///< `order` is the shard of each item instead
  std::vector<double> seconds;
  std::vector<std::size_t> order;
  std::size_t workers;
  double total, tail, idleShare;
};

TEST(Schedule, ItemsFillTheCoresAndTheLastIsTheTail) {
  const std::vector<ScheduleRow> rows = {
      {"equal items", false, std::vector<double>(12, 2.0), {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, 4, 6.0, 2.0, 0.0},
      {"a long item last", false, {1, 1, 1, 1, 10}, {0, 1, 2, 3, 4}, 2, 12.0, 10.0, 1.0 - 14.0 / 24.0},
      {"a shard with more", true, {3, 1, 1}, {0, 0, 1}, 2, 4.0, 3.0, 1.0 - 5.0 / 8.0}};
  for (const auto& [what, shards, seconds, order, workers, total, tail, idleShare] : rows) {
    SCOPED_TRACE(what);
    const Schedule schedule = (shards ? simulateShards : simulateSchedule)(seconds, order, workers);
    EXPECT_DOUBLE_EQ(schedule.seconds, total);
    EXPECT_DOUBLE_EQ(schedule.tail, tail);
    EXPECT_DOUBLE_EQ(schedule.idleShare, idleShare);
  }
  const Schedule early = simulateSchedule(rows[1].seconds, std::vector<std::size_t>{4, 0, 1, 2, 3}, 2);
  EXPECT_DOUBLE_EQ(early.seconds, 10.0);
  EXPECT_DOUBLE_EQ(early.longest, 10.0);
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
