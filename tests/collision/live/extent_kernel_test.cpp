#include "collision/live/extent_kernel.h"

#include "tests/collision/parts.h"
#include "tests/support/instruction_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace lorica {
namespace {

void expectSameAsSlow() {
  std::mt19937_64 random(82);
  for (std::size_t count = 0; count < 40; ++count) {
    std::vector<Vec3> points(count);
    for (Vec3& p : points) p = test::uniformVec3(random, -2.0, 2.0);
    Isometry3 motion = Isometry3::Identity();
    motion.linear() = Quat(Eigen::AngleAxisd(test::uniform(random, -3.0, 3.0), Vec3(1.0, 2.0, -2.0) / 3.0)).matrix();
    motion.translation() = test::uniformVec3(random, -5.0, 5.0);
    Aabb slow;
    double slowSq = 0.0;
    for (const Vec3& p : points) {
      slow.extend(motion * p);
      slowSq = std::max(slowSq, p.squaredNorm());
    }
    const Aabb bounds = boundsOf(points, motion);
    EXPECT_EQ(farthestSq(points), slowSq) << count << " points";
    EXPECT_EQ(bounds.empty(), count == 0);
    if (count == 0) continue;
    EXPECT_LT((bounds.min - slow.min).norm(), 1e-14) << count << " points";
    EXPECT_LT((bounds.max - slow.max).norm(), 1e-14) << count << " points";
  }
}

TEST(ExtentKernel, HoldsAllPointsWithEveryInstructionSet) {
  test::onEveryInstructionSet(expectSameAsSlow);
}

}  // namespace
}  // namespace lorica
