#include "collision/live/choose_cover.h"

#include "collision/live/live_body.h"
#include "tests/collision/dancer.h"
#include "tests/collision/parts.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

namespace lorica {
namespace {

/// A dancer with poses to choose in and held-out poses.
struct Rehearsal {
  test::Dancer dancer;
  std::vector<LiftedPoint> lifted = liftPoints(dancer.character, dancer.decomposition);
  std::vector<Affine3> sampled = poses(20, 31);
  std::vector<Affine3> heldOut = poses(10, 32);

  [[nodiscard]] BonePoseView view(const std::vector<Affine3>& poses) const {
    return {poses, dancer.character.skeleton.jointCount()};
  }
  std::vector<Affine3> poses(int count, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<Affine3> all;
    for (int p = 0; p < count; ++p) {
      dancer.dance(random, 0.5);
      all.insert(all.end(), dancer.worldFromModel.begin(), dancer.worldFromModel.end());
    }
    return all;
  }
  [[nodiscard]] Result<HullCover> choose(const CoverSettings& settings) const {
    return chooseCover(dancer.decomposition, lifted, view(sampled), view(heldOut), settings);
  }
  /// How far any point of the body is outside its part's hull in any of some poses [m].
  double farthestOut(const HullCover& cover, const std::vector<Affine3>& poses) {
    LiveBody body = LiveBody::create(dancer.decomposition, dancer.character, cover).value();
    double farthest = 0.0;
    for (int p = 0; p < view(poses).poseCount(); ++p) {
      const auto pose = view(poses).pose(p);
      body.update(pose);
      dancer.worldFromModel.assign(pose.begin(), pose.end());
      const std::vector<Vec3> points = dancer.points();
      for (std::size_t i = 0; i < body.parts().size(); ++i) {
        std::vector<Vec3> own;
        for (const PointIndex k : dancer.decomposition.parts[i].points) own.push_back(points[k]);
        farthest = std::max(farthest, largestViolation(worldHull(body.parts()[i]), own));
      }
    }
    return farthest;
  }
};

TEST(Cover, ExactKeepsAllCandidatesWhereTheyAre) {
  const Rehearsal r;
  const HullCover exact = coverExactly(r.dancer.decomposition, r.lifted);
  EXPECT_EQ(exact.tolerance, 0.0);
  EXPECT_EQ(exact.growth, 0.0);
  for (std::size_t i = 0; i < exact.points.size(); ++i) {
    const std::vector<PointIndex> candidates =
        hullCandidates(r.dancer.decomposition, r.dancer.decomposition.parts[i], r.lifted);
    ASSERT_EQ(exact.points[i].size(), candidates.size());
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      EXPECT_EQ(exact.points[i][k].point, candidates[k]);
      EXPECT_TRUE(exact.points[i][k].outward.isZero());
    }
  }
  // No tolerance and no limit request the same.
  const HullCover asked = test::valueOf(r.choose({}));
  EXPECT_EQ(asked.sampledPoses, 0);
  EXPECT_EQ(asked.points.front().size(), exact.points.front().size());
}

TEST(Cover, CoversTheBodyInSampledPosesAndReportsWhatProtrudesInOthers) {
  Rehearsal r;
  const double height = r.dancer.character.height;
  for (const CoverSettings& settings : {CoverSettings{.tolerance = 0.004}, CoverSettings{.maxHullVertices = 24},
                                        CoverSettings{.tolerance = 0.02, .maxHullVertices = 255}}) {
    SCOPED_TRACE(testing::Message() << settings.tolerance << ", " << settings.maxHullVertices);
    const HullCover cover = test::valueOf(r.choose(settings));
    EXPECT_EQ(cover.sampledPoses, 20);
    EXPECT_EQ(cover.heldOutPoses, 10);
    for (const std::vector<CoverPoint>& points : cover.points) {
      EXPECT_GE(points.size(), 4u);
      const int max = settings.maxHullVertices > 0 ? settings.maxHullVertices : 100000;
      EXPECT_LE(points.size(), static_cast<std::size_t>(max));
      for (const CoverPoint& p : points) EXPECT_LE(p.outward.norm(), cover.growth * (1.0 + 1e-12));
    }
    EXPECT_LE(cover.sampledShortfall, settings.maxHullVertices == 0 ? settings.tolerance : 0.1);
    EXPECT_LT(r.farthestOut(cover, r.sampled), 1e-6 * height);
    EXPECT_NEAR(r.farthestOut(cover, r.heldOut), cover.heldOutShortfall, 1e-6 * height);
  }
}

TEST(Cover, FewerPointsAreNeededForALooserCover) {
  const Rehearsal r;
  std::size_t before = 100000;
  for (const double tolerance : {0.002, 0.005, 0.02}) {
    const HullCover cover = test::valueOf(r.choose({.tolerance = tolerance}));
    std::size_t count = 0;
    for (const auto& points : cover.points) count += points.size();
    EXPECT_LT(count, before);
    before = count;
  }
}

TEST(Cover, IsTheSameOnAnyNumberOfThreads) {
  const Rehearsal r;
  const Result<HullCover> one = r.choose({.maxHullVertices = 16, .threads = 1});
  const Result<HullCover> three = r.choose({.maxHullVertices = 16, .threads = 3});
  ASSERT_TRUE(one.ok() && three.ok());
  for (std::size_t i = 0; i < one->points.size(); ++i) {
    ASSERT_EQ(one->points[i].size(), three->points[i].size());
    for (std::size_t k = 0; k < one->points[i].size(); ++k) {
      EXPECT_EQ(one->points[i][k].point, three->points[i][k].point);
      EXPECT_EQ(one->points[i][k].outward, three->points[i][k].outward);
    }
  }
  EXPECT_EQ(one->heldOutShortfall, three->heldOutShortfall);
}

TEST(Cover, WrongSettingsGetASentenceAndProgressCancels) {
  const Rehearsal r;
  for (const CoverSettings& wrong : {CoverSettings{.tolerance = -0.1}, CoverSettings{.maxHullVertices = 3}}) {
    const Result<HullCover> refused = r.choose(wrong);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
  }
  std::atomic<int> calls = 0;
  const Result<HullCover> cancelled = r.choose({.maxHullVertices = 16, .progress = [&](int, int) {
                                                  ++calls;
                                                  return false;
                                                }});
  ASSERT_FALSE(cancelled.ok());
  EXPECT_EQ(cancelled.error().code, ErrorCode::kCancelled);
  EXPECT_GE(calls, 1);
  EXPECT_LT(calls, 8);
}

}  // namespace
}  // namespace lorica
