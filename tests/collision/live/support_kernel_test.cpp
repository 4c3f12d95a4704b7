#include "collision/live/support_kernel.h"

#include "tests/collision/parts.h"
#include "tests/support/instruction_sets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace lorica {
namespace {

/// The first of the farthest points, one by one.
int slowSupport(const std::vector<float>& xyz, int count, const Vec3f& direction) {
  int best = 0;
  float max = -std::numeric_limits<float>::infinity();
  for (int i = 0; i < count; ++i) {
    const auto at = [&](int axis) { return xyz[axis * count + i]; };
    const float value = direction.x() * at(0) + direction.y() * at(1) + direction.z() * at(2);
    if (value > max) {
      max = value;
      best = i;
    }
  }
  return best;
}

void expectSameAsSlow() {
  std::mt19937_64 random(81);
  for (const int count : {16, 32, 48, 64, 304, 1024}) {
    for (int i = 0; i < 200; ++i) {
      // Coarse coordinates and directions: many points are equally far.
      std::vector<float> xyz(3 * static_cast<std::size_t>(count));
      const bool coarse = i % 2 == 0;
      for (float& c : xyz) {
        const double value = test::uniform(random, -4.0, 4.0);
        c = static_cast<float>(coarse ? std::round(value) : value);
      }
      Vec3f direction = test::uniformVec3(random, -1.0, 1.0).cast<float>();
      if (coarse) direction = direction.array().round();
      const float* x = xyz.data();
      EXPECT_EQ(supportIndex(x, x + count, x + 2 * count, count, direction.x(), direction.y(), direction.z()),
                slowSupport(xyz, count, direction))
          << count << " points, case " << i;
    }
  }
}

TEST(SupportKernel, FindsTheFirstFarthestPointWithEveryInstructionSet) {
  test::onEveryInstructionSet(expectSameAsSlow);
}

TEST(SupportKernel, ADirectionThatIsNoNumberGivesAPoint) {
  const std::vector<float> xyz(48, 1.0f);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(supportIndex(xyz.data(), xyz.data() + 16, xyz.data() + 32, 16, nan, nan, nan), 0);
}

}  // namespace
}  // namespace lorica
