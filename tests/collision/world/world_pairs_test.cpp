#include "collision/world/world.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

namespace lorica {
namespace {

long peakMegabytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

/// 700 boxes in one place are 244,650 pairs, which took 900 MB.
TEST(WorldPairs, BoxesInOnePlaceTakeBoundedMemory) {
  const long before = peakMegabytes();
  World world;
  Prop box;
  box.worldFromProp.translation() = Vec3(0.0, 1.0, 0.0);
  for (int i = 0; i < 700; ++i) world.addProp(box);
  world.step({}, 1.0 / 240.0);
  EXPECT_LT(peakMegabytes() - before, 400);
  for (const Prop& prop : world.props()) EXPECT_TRUE(prop.worldFromProp.matrix().allFinite());
}

}  // namespace
}  // namespace lorica
