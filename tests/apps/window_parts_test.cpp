#include "acd/decompose.h"
#include "apps/detail_levels.h"
#include "apps/window_warnings.h"
#include "collision/live_body.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace lorica {
namespace {

const Character& mannequin() {
  static const Character character = makeMannequin();
  return character;
}

const Decomposition& sixParts() {
  static const Decomposition result = [] {
    DecomposeSettings settings;
    settings.maxParts = 6;
    const PoseView bindPose{mannequin().mesh.vertices, static_cast<int>(mannequin().mesh.vertices.size())};
    Result<Decomposition> made = decompose(mannequin().mesh, bindPose, settings);
    EXPECT_TRUE(made.ok()) << made.error().message;
    return std::move(made).value();
  }();
  return result;
}

/// A pose that is not the bind pose: every joint turned a little.
std::vector<Affine3> bentBones() {
  Pose pose = restPose(mannequin().skeleton);
  for (std::size_t j = 0; j < pose.size(); ++j) {
    pose[j].rotation = pose[j].rotation * Quat(Eigen::AngleAxisd(j % 2 == 0 ? 0.3 : -0.25, Vec3(1, 2, 3).normalized()));
  }
  std::vector<Affine3> worldFromJoint(pose.size()), worldFromModel(pose.size());
  computeWorldFromJoint(mannequin().skeleton, pose, worldFromJoint);
  computeWorldFromModel(mannequin(), worldFromJoint, worldFromModel);
  return worldFromModel;
}

/// How far the farthest vertex of the posed mesh is outside all hulls [m].
double farthestOutside(const LiveBody& body, std::span<const Affine3> bones) {
  std::vector<Vec3> posed(mannequin().mesh.vertices.size());
  skinLinearBlend(mannequin(), bones, posed);
  double farthest = 0.0;
  for (std::size_t v = 0; v < posed.size(); v += 7) {
    double nearest = 1e9;
    for (const LivePart& part : body.parts()) {
      const ConvexHull hull = worldHull(part);
      double outside = -1e9;
      for (const Triangle& t : hull.triangles) {
        const Vec3& a = hull.vertices[static_cast<std::size_t>(t[0])];
        const Vec3& b = hull.vertices[static_cast<std::size_t>(t[1])];
        const Vec3& c = hull.vertices[static_cast<std::size_t>(t[2])];
        const Vec3 normal = (b - a).cross(c - a);
        if (normal.norm() < 1e-12) continue;
        outside = std::max(outside, normal.normalized().dot(posed[v] - a));
      }
      nearest = std::min(nearest, outside);
    }
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

TEST(DetailLevels, EveryLevelHasItsPartsAndHoldsTheBody) {
  const auto finest = std::make_shared<const BodyPlan>(sixParts(), mannequin());
  const std::vector<Affine3> bones = bentBones();
  double before = 1e9;
  for (int parts = 1; parts <= 6; ++parts) {
    const std::shared_ptr<const BodyPlan> plan = planOfLevel(finest, mannequin(), parts);
    ASSERT_EQ(plan->parts().size(), static_cast<std::size_t>(parts));
    LiveBody body(plan);
    body.update(bones);
    EXPECT_LT(farthestOutside(body, bones), 1e-6) << parts << " parts";
    double volume = 0.0;
    for (const LivePart& part : body.parts()) volume += part.shape.volume;
    EXPECT_LT(volume, before) << parts << " parts are closer than one fewer";
    before = volume;
  }
  EXPECT_EQ(planOfLevel(finest, mannequin(), 6), finest);
}

TEST(DetailLevels, ChosenPointsStayChosenWherePartsAreJoined) {
  // A promise of three points a part, pushed out: any will do here.
  const BodyPlan all(sixParts(), mannequin());
  CoverPromise promise = all.coverage();
  promise.tolerance = 0.01;
  promise.maxHullVertices = 4;
  std::size_t count = 0;
  for (std::vector<CoverPoint>& points : promise.points) {
    points.resize(std::min<std::size_t>(points.size(), 4));
    for (CoverPoint& p : points) p.outward = Vec3(0.0, 0.001, 0.0);
    count += points.size();
  }
  const auto finest = std::make_shared<const BodyPlan>(sixParts(), mannequin(), promise);
  const std::shared_ptr<const BodyPlan> one = planOfLevel(finest, mannequin(), 1);
  ASSERT_EQ(one->coverage().points.size(), 1u);
  EXPECT_EQ(one->coverage().points[0].size(), count);
  EXPECT_EQ(one->coverage().tolerance, 0.01);
  EXPECT_EQ(one->coverage().maxHullVertices, 0) << "no longer kept";
  LiveBody body(one);
  body.update(bentBones());
  EXPECT_FALSE(body.parts()[0].shape.degenerate());
}

TEST(DetailLevels, AreMadeOffTheFrameAndTheLastOneAskedForComes) {
  const auto finest = std::make_shared<const BodyPlan>(sixParts(), mannequin());
  DetailLevels levels(finest, mannequin());
  EXPECT_EQ(levels.mostParts(), 6);
  EXPECT_EQ(levels.take(), nullptr) << "nothing was asked for";
  const auto wait = [&levels] {
    std::shared_ptr<const BodyPlan> plan;
    while ((plan = levels.take()) == nullptr) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return plan;
  };
  levels.ask(2);
  (void)levels.take();
  levels.ask(4);
  EXPECT_EQ(levels.asked(), 4);
  const std::shared_ptr<const BodyPlan> four = wait();
  EXPECT_EQ(four->parts().size(), 4u);
  EXPECT_FALSE(levels.asked().has_value());
  EXPECT_EQ(levels.take(), nullptr) << "once";
  levels.ask(6);
  EXPECT_EQ(levels.take(), finest) << "is there at once";
  levels.ask(4);
  EXPECT_EQ(levels.take(), four) << "is kept";
}

TEST(WindowWarnings, NameWhatIsLost) {
  const Skeleton& skeleton = mannequin().skeleton;
  std::vector<double> trust(static_cast<std::size_t>(skeleton.jointCount()), 1.0);
  const auto lose = [&](HumanBone bone) { trust[static_cast<std::size_t>(skeleton.jointOf(bone))] = 0.0; };
  EXPECT_EQ(lostLimbs(skeleton, {}), "");
  EXPECT_EQ(lostLimbs(skeleton, trust), "");
  lose(HumanBone::kLeftHand);
  EXPECT_EQ(lostLimbs(skeleton, trust), "left hand lost");
  lose(HumanBone::kLeftLowerArm);
  lose(HumanBone::kRightUpperLeg);
  lose(HumanBone::kHead);
  const std::string four = lostLimbs(skeleton, trust);
  EXPECT_NE(four.find("and 1 more lost"), std::string::npos) << four;
  std::fill(trust.begin(), trust.end(), 0.2);
  EXPECT_EQ(lostLimbs(skeleton, trust), "the whole body is lost");
}

}  // namespace
}  // namespace lorica
