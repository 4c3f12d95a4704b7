#include "collision/live/moving_hull.h"

#include "collision/live/live_body.h"
#include "tests/collision/dancer.h"
#include "tests/collision/live/moving_hull_truth.h"
#include "tests/collision/parts.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <limits>

namespace lorica::test {
namespace {

TEST(MovingHull, UpdatesAllocateNothing) {
  std::mt19937_64 random(3);
  std::vector<Vec3> points(300);
  for (Vec3& p : points) p = uniformVec3(random, -1.0, 1.0);
  std::vector<std::vector<PointRow>> frames;
  for (int frame = 0; frame < 40; ++frame) {
    // Small steps, then large jumps, then a flat shape, then no extent at all.
    const double size = frame < 15 ? 1e-3 : frame < 30 ? 1.0 : 0.0;
    for (Vec3& p : points) p += size * uniformVec3(random, -1.0, 1.0);
    std::vector<Vec3> posed = points;
    if (frame % 10 == 9) {
      for (Vec3& p : posed) p.z() = 0.0;
    }
    frames.push_back(aboutTheirMean(posed, 1e5));
  }

  MovingHull hull(300);
  const long before = allocationCount();
  ASSERT_GT(before, 0) << "the counter works: the setup allocated memory";
  MovingHull::Counts sum;
  for (const std::vector<PointRow>& rows : frames) {
    hull.update(rows);
    sum.turnedFaces += hull.counts().turnedFaces;
    sum.flips += hull.counts().flips;
    sum.deletions += hull.counts().deletions;
    sum.rebuilds += hull.counts().rebuilds;
    (void)hull.support(Vec3::UnitX(), 0);
    (void)hull.volume();
  }
  EXPECT_EQ(allocationCount() - before, 0);
  EXPECT_GT(sum.turnedFaces * sum.flips * sum.deletions, 0) << "every kind of repair occurred";
  EXPECT_GT(sum.rebuilds, 3);
}

TEST(LiveBody, FramesOfACharacterAllocateNothing) {
  Dancer dancer;
  std::mt19937_64 random(4);
  std::vector<std::vector<Affine3>> frames;
  for (int frame = 0; frame < 12; ++frame) {
    dancer.dance(random, frame % 3 == 0 ? 1.5 : 0.1);
    frames.push_back(dancer.worldFromModel);
  }
  for (Affine3& bone : frames[5]) bone.matrix().setConstant(std::numeric_limits<double>::quiet_NaN());
  for (Affine3& bone : frames[8]) bone.linear() *= 1e-3;
  // The first frame in which another thread helps would allocate, whichever that is.
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  LiveBody body = LiveBody::create(dancer.decomposition, dancer.character).value();
  LiveBody copy = body;
  LiveBody assigned(body.plan(), LiveDetail::kSupport);
  assigned = copy;
  LiveBody ofPlan(body.plan());
  const long before = allocationCount();
  for (LiveBody* one : {&body, &copy, &assigned, &ofPlan}) {
    for (const std::vector<Affine3>& frame : frames) {
      one->update(frame);
      (void)one->support(0, Vec3::UnitY());
    }
  }
  EXPECT_EQ(allocationCount() - before, 0);
}

}  // namespace
}  // namespace lorica::test
