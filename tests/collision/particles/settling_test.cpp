#include "collision/particles/particles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace lorica::test {
namespace {

/// A block of sand that falls from 20 cm and settles for half a second: 15 frames.
ParticleSettings fallingSand() {
  ParticleSettings settings;
  settings.radius = 0.02;
  settings.fills.push_back({Vec3(0.0, 0.4, 0.0), Vec3(0.4, 0.4, 0.4)});
  settings.settleSeconds = 0.5;
  return settings;
}

bool sameBits(const Particles& a, const Particles& b) {
  return std::equal(a.positions().begin(), a.positions().end(), b.positions().begin(), b.positions().end());
}

TEST(Settling, ParticlesThatHaveSettledBeforeTheFirstStepMoveAsIfTheySettledInIt) {
  Particles inStep(fallingSand()), before(fallingSand());
  EXPECT_FALSE(before.settled());
  EXPECT_TRUE(before.settle({}));
  EXPECT_TRUE(before.settled());
  const double lowest = 0.2;
  EXPECT_TRUE(std::any_of(before.positions().begin(), before.positions().end(), [&](const Vec3f& p) {
    return p.y() < 0.5 * lowest;
  })) << "it has fallen";
  for (int frame = 0; frame < 3; ++frame) {
    inStep.step({}, 1.0 / 30.0);
    before.step({}, 1.0 / 30.0);
    EXPECT_TRUE(sameBits(inStep, before)) << frame;
  }
}

TEST(Settling, WhoWatchesIsToldOfEachFrameAndCanStopIt) {
  Particles particles(fallingSand());
  std::vector<int> frames;
  particles.watchSettling([&](int frame, int count) {
    EXPECT_EQ(count, 15);
    frames.push_back(frame);
    return frame < 3;
  });
  EXPECT_FALSE(particles.settle({}));
  EXPECT_EQ(frames, (std::vector<int>{1, 2, 3}));
}

}  // namespace
}  // namespace lorica::test
