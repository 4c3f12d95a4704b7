#include "geometry/clock.h"

#include <gtest/gtest.h>

#include <limits>
#include <optional>

namespace lorica {
namespace {

TEST(TimeLeft, OfEvenWorkIsWhatItTakes) {
  TimeLeft left;
  EXPECT_FALSE(left.update(1, 10, 1.0)) << "too early";
  EXPECT_EQ(left.update(3, 10, 3.0), 7.0);
  EXPECT_EQ(left.update(4, 10, 4.0), 6.0);
  EXPECT_FALSE(left.update(10, 10, 10.0));
  EXPECT_FALSE(left.update(3, 0, 11.0)) << "unknown total";
}

TEST(TimeLeft, NeverRises) {
  // The large items first, then one that hangs: items end after these seconds.
  for (const bool hangs : {false, true}) {
    TimeLeft left;
    double last = std::numeric_limits<double>::infinity();
    int done = 0, told = 0;
    for (double seconds = 0.0; seconds < 200.0; seconds += 0.25) {
      const double needed = done < 3 ? 10.0 * (done + 1) : 30.0 + (done - 2) * (hangs ? 20.0 : 1.0);
      if (seconds >= needed && done < 10) ++done;
      const std::optional<double> now = left.update(done, 10, seconds);
      if (!now) continue;
      ++told;
      EXPECT_GT(*now, 0.0);
      EXPECT_LE(*now, last) << seconds;
      last = *now;
    }
    EXPECT_GT(told, 20);
  }
}

}  // namespace
}  // namespace lorica
