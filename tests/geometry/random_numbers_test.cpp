#include "geometry/random_numbers.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

TEST(RandomNumbers, AreThoseOfSplitMix64) {
  // The published values for seed 1234567: https://rosettacode.org/wiki/Pseudo-random_numbers/Splitmix64
  RandomNumbers random(1234567);
  for (const std::uint64_t expected : {6457827717110365317u, 3203168211198807973u, 9817491932198370423u,
                                       4593380528125082431u, 16408922859458223821u}) {
    EXPECT_EQ(random.bits(), expected);
  }
}

TEST(RandomNumbers, FillTheUnitIntervalEvenly) {
  RandomNumbers random(3);
  double sum = 0.0, sumOfUnits = 0.0;
  for (std::uint64_t i = 0; i < 10'000; ++i) {
    const double a = random.unit(), b = randomUnit(3, i);
    ASSERT_TRUE(a >= 0.0 && a < 1.0 && b >= 0.0 && b < 1.0);
    sum += a;
    sumOfUnits += b;
  }
  // The standard deviation of the mean of 10,000 is 0.0029.
  EXPECT_NEAR(sum / 10'000, 0.5, 0.015);
  EXPECT_NEAR(sumOfUnits / 10'000, 0.5, 0.015);
}

}  // namespace
}  // namespace lorica
