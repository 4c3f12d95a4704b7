#include "export/rigid_colliders.h"

#include "export/capsule.h"
#include "export/collider_fit.h"
#include "geometry/counts.h"
#include "geometry/random_numbers.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/export/stick_figure.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace lorica {
namespace {

// Rigid colliders against what they promise: in the poses that they are made from they hold the whole surface.

const std::vector<double> kBends = {0.0, 0.9, -0.4, 1.4};

std::vector<RigidCollider> collidersOf(const Character& character, std::span<const Affine3> poses,
                                       const RigidColliderSettings& settings = {}) {
  return makeRigidColliders(character, test::onePart(character), {poses, character.skeleton.jointCount()}, settings)
      .value();
}

/// The farthest that a vertex is outside all colliders, by their planes.
double farthestOutside(const Character& character, std::span<const RigidCollider> colliders,
                       std::span<const Affine3> bones) {
  std::vector<Vec3> posed(character.mesh.vertices.size());
  skinLinearBlend(character, bones, posed);
  double farthest = 0.0;
  for (const Vec3& p : posed) {
    double least = kInfinity;
    for (const RigidCollider& collider : colliders) {
      const Vec3 local = bones[collider.joint].inverse() * p;
      double outside = -kInfinity;
      for (const Triangle& t : collider.hull.triangles) {
        const Vec3& a = collider.hull.vertices[t[0]];
        const Vec3 normal = (collider.hull.vertices[t[1]] - a).cross(collider.hull.vertices[t[2]] - a);
        if (normal.norm() < 1e-12) continue;
        outside = std::max(outside, normal.normalized().dot(local - a));
      }
      least = std::min(least, outside);
    }
    farthest = std::max(farthest, least);
  }
  return farthest;
}

TEST(RigidColliders, HoldTheSurfaceInEveryPoseThatTheyAreMadeFrom) {
  const Character figure = test::stickFigure();
  const std::vector<Affine3> poses = test::bentPoses(figure, kBends);
  for (const int limit : {0, 16}) {
    const std::vector<RigidCollider> colliders = collidersOf(figure, poses, {{limit}, false, 1});
    ASSERT_EQ(colliders.size(), 2U);
    for (std::size_t k = 0; k < kBends.size(); ++k) {
      EXPECT_LT(farthestOutside(figure, colliders, std::span(poses).subspan(2 * k, 2)), 1e-6) << "pose " << k;
    }
    for (const RigidCollider& collider : colliders) {
      if (limit > 0) {
        EXPECT_LE(collider.hull.vertices.size(), 16U);
      }
      EXPECT_NEAR(collider.volume, signedVolume(collider.hull.vertices, collider.hull.triangles), 1e-9);
      for (const Vec3& p : limit == 0 ? collider.hull.vertices : std::vector<Vec3>()) {
        EXPECT_LE(collider.capsule.outside(p), 1e-9);
      }
    }
  }
}

TEST(RigidColliders, SplitVerticesCountOnce) {
  const Character figure = test::stickFigure();
  // Every triangle with vertices of its own, as files have it for normals and textures.
  Character split = figure;
  split.mesh = {};
  split.influences.clear();
  split.influenceBegin = {0};
  for (const Triangle& t : figure.mesh.triangles) {
    const VertexIndex first = countOf(split.mesh.vertices);
    split.mesh.triangles.push_back({first, first + 1, first + 2});
    for (const VertexIndex v : t) {
      split.mesh.vertices.push_back(figure.mesh.vertices[v]);
      split.influences.insert(split.influences.end(), figure.influences.begin() + figure.influenceBegin[v],
                              figure.influences.begin() + figure.influenceBegin[v + 1]);
      split.influenceBegin.push_back(static_cast<std::uint32_t>(split.influences.size()));
    }
  }
  const std::vector<LiftedPoint> lifted = liftPoints(split, test::onePart(split));
  std::vector<PointIndex> first = firstAlike(lifted);
  std::ranges::sort(first);
  EXPECT_EQ(std::ranges::distance(first.begin(), std::unique(first.begin(), first.end())),
            countOf(figure.mesh.vertices));
  const std::vector<Affine3> poses = test::bentPoses(figure, kBends);
  const std::vector<RigidCollider> one = collidersOf(figure, poses, {{}, true, 1}),
                                   same = collidersOf(split, poses, {{}, true, 1});
  ASSERT_EQ(one.size(), same.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].joint, same[i].joint);
    EXPECT_NEAR(one[i].volume, same[i].volume, 1e-12);
    EXPECT_EQ(one[i].hull.vertices.size(), same[i].hull.vertices.size());
  }
}

TEST(RigidColliders, OfABodyThatDoesNotBendAreItsHalvesOrOneBones) {
  Character figure = test::stickFigure();
  const std::vector<RigidCollider> halves = collidersOf(figure, test::bentPoses(figure, {0.0, 0.0}));
  ASSERT_EQ(halves.size(), 2U);
  for (int half = 0; half < 2; ++half) {
    EXPECT_EQ(halves[half].joint, half);
    EXPECT_NEAR(halves[half].volume, 0.04 * 1.0, 1e-6);
  }
  for (Influence& influence : figure.influences) influence.joint = 0;
  const std::vector<RigidCollider> one = collidersOf(figure, test::bentPoses(figure, kBends));
  ASSERT_EQ(one.size(), 1U);
  EXPECT_NEAR(one[0].volume, 0.04 * 2.0, 1e-6);
}

TEST(RigidColliders, StickOutOnlyInOtherPoses) {
  const Character figure = test::stickFigure();
  const std::vector<RigidCollider> colliders = collidersOf(figure, test::bentPoses(figure, {0.0}));
  EXPECT_GT(farthestOutside(figure, colliders, test::bentPoses(figure, {1.2})), 0.005);
}

TEST(RigidColliders, DoNotDependOnThreads) {
  const Character mannequin = makeMannequin();
  Pose pose = restPose(mannequin.skeleton);
  pose[mannequin.skeleton.jointOf(HumanBone::kLeftLowerArm)].rotation = Quat(Eigen::AngleAxisd(1.0, Vec3::UnitY()));
  std::vector<Affine3> bones(pose.size());
  computeWorldFromJoint(mannequin.skeleton, pose, bones);
  computeWorldFromModel(mannequin, bones, bones);
  const std::vector<RigidCollider> one = collidersOf(mannequin, bones, {{32}, true, 1});
  const std::vector<RigidCollider> many = collidersOf(mannequin, bones, {{32}, true, 5});
  ASSERT_EQ(one.size(), many.size());
  EXPECT_GT(one.size(), 20U);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].joint, many[i].joint);
    EXPECT_EQ(one[i].hull.vertices, many[i].hull.vertices);
    EXPECT_EQ(one[i].hull.triangles, many[i].hull.triangles);
    EXPECT_EQ(one[i].part, -1);
  }
}

TEST(RigidColliders, FlatSkinGetsAThickness) {
  Character flat = test::stickFigure();
  for (Vec3& p : flat.mesh.vertices) p.z() = 0.0;
  const std::vector<RigidCollider> colliders = collidersOf(flat, test::bentPoses(flat, {0.0}));
  ASSERT_EQ(colliders.size(), 2U);
  for (const RigidCollider& collider : colliders) {
    EXPECT_GE(collider.hull.triangles.size(), 4U);
    EXPECT_GT(collider.volume, 1e-5);
  }
}

TEST(RigidColliders, ABoneScaledToNothingIsRefused) {
  const Character figure = test::stickFigure();
  std::vector<Affine3> poses = test::bentPoses(figure, {0.0});
  poses[1].linear().setZero();
  const auto made = makeRigidColliders(figure, test::onePart(figure), {poses, 2}, {});
  ASSERT_FALSE(made.ok());
  EXPECT_TRUE(test::has(made.error().message, "'upper'"));
}

TEST(RigidColliders, AreStoppedWhereTheirProgressSays) {
  const Character figure = test::stickFigure();
  const std::vector<Affine3> poses = test::bentPoses(figure, {0.0});
  const auto stop = [](int done, int all) { return done > all; };
  const auto made = makeRigidColliders(figure, test::onePart(figure), {poses, 2}, {{}, false, 1, stop});
  EXPECT_EQ(made.error().code, ErrorCode::kCancelled);
  const std::vector<RigidCollider> colliders = collidersOf(figure, poses);
  EXPECT_EQ(measureFit(figure, colliders, {poses, 2}, 1, stop).error().code, ErrorCode::kCancelled);
}

// The measured fit against boxes whose distances are known.

/// A figure that follows one bone, and a box around it or inside it as its collider.
ColliderFits fitOfBox(double grown) {
  Character figure = test::stickFigure();
  for (Influence& influence : figure.influences) influence.joint = 0;
  RigidCollider collider;
  collider.hull = test::makeBox(Vec3(-0.1 - grown, -grown, -0.1 - grown), Vec3(0.1 + grown, 2.0 + grown, 0.1 + grown));
  collider.volume = signedVolume(collider.hull.vertices, collider.hull.triangles);
  collider.capsule = capsuleAround(collider.hull.vertices);
  const std::vector<Affine3> poses = test::bentPoses(figure, {0.3, -0.8, 0.0});
  return measureFit(figure, std::span(&collider, 1), {poses, 2}, 1).value();
}

TEST(ColliderFit, IsZeroForTheSkinItselfAndMeasuresLargerAndSmallerBoxes) {
  const ColliderFits own = fitOfBox(0.0);
  EXPECT_NEAR(own.hulls.worstOut, 0.0, 1e-9);
  EXPECT_NEAR(own.hulls.worstStandOff, 0.0, 1e-9);
  EXPECT_NEAR(own.hulls.shareOut, 0.0, 1e-12);
  EXPECT_NEAR(own.hulls.volume, 0.08, 1e-12);
  EXPECT_GT(own.capsules.meanStandOff, 0.01);
  const ColliderFits larger = fitOfBox(0.03);
  EXPECT_EQ(larger.hulls.worstOut, 0.0);
  EXPECT_GE(larger.hulls.meanStandOff, 0.0299);
  EXPECT_LE(larger.hulls.worstStandOff, 0.03 * std::sqrt(3.0) + 1e-9);
  EXPECT_GE(larger.hulls.worstStandOff, larger.hulls.meanStandOff);
  const ColliderFits smaller = fitOfBox(-0.02);
  EXPECT_NEAR(smaller.hulls.worstOut, 0.02 * std::sqrt(3.0), 1e-9);  // the corners of the bar
  EXPECT_NEAR(smaller.hulls.meanWorstOut, 0.02 * std::sqrt(3.0), 1e-9);
  EXPECT_NEAR(smaller.hulls.shareOut, 1.0, 1e-12);
  EXPECT_EQ(smaller.hulls.worstStandOff, 0.0);
}

constexpr double kPi = std::numbers::pi;

std::vector<Vec3> pointsOn(const Capsule& capsule, int count) {
  RandomNumbers random(1);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double x = random.between(-1.0, 1.0), y = random.between(-1.0, 1.0), z = random.between(-1.0, 1.0);
    const Vec3 direction = Vec3(x, y, z).normalized();
    const bool up = direction.dot(capsule.to - capsule.from) > 0.0;
    points.push_back((up ? capsule.to : capsule.from) + capsule.radius * direction);
  }
  return points;
}

TEST(Capsule, HasTheVolumeOfABallAndACylinderAndTheDistancesOfItsSegment) {
  EXPECT_NEAR((Capsule{Vec3::Zero(), Vec3::Zero(), 0.5}.volume()), 4.0 / 3.0 * kPi * 0.125, 1e-12);
  EXPECT_NEAR((Capsule{Vec3::Zero(), Vec3(0, 2, 0), 0.5}.volume()), 4.0 / 3.0 * kPi * 0.125 + 2.0 * kPi * 0.25, 1e-12);
  const Capsule capsule{Vec3(1, 0, 0), Vec3(3, 0, 0), 0.5};
  EXPECT_NEAR(capsule.outside(Vec3(2, 2, 0)), 1.5, 1e-12);
  EXPECT_NEAR(capsule.outside(Vec3(6, 0, 4)), 4.5, 1e-12);
  EXPECT_NEAR(capsule.outside(Vec3(2, 0.1, 0)), -0.4, 1e-12);
}

TEST(Capsule, AroundPointsOfACapsuleIsNearlyThatCapsule) {
  const Capsule truth{Vec3(0.1, 0.2, 0.3), Vec3(0.5, 1.4, 0.2), 0.2};
  const std::vector<Vec3> points = pointsOn(truth, 2000);
  const Capsule found = capsuleAround(points);
  for (const Vec3& p : points) EXPECT_LE(found.outside(p), 1e-9);
  EXPECT_LT(found.volume(), 1.15 * truth.volume());
}

TEST(Capsule, HoldsAnyPointsAndNeverMuchMoreThanTheirBall) {
  RandomNumbers random(7);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Vec3> points;
    for (int i = 0; i < 1 + trial % 9; ++i) {
      const double x = random.unit(), y = random.unit(), z = random.unit();
      points.emplace_back(x, 0.1 * y, 3.0 * z);
    }
    const Capsule capsule = capsuleAround(points);
    for (const Vec3& p : points) EXPECT_LE(capsule.outside(p), 1e-9) << "trial " << trial;
    EXPECT_LT(capsule.radius, 3.2);
  }
}

TEST(Capsule, KeepsItsMiddleWithAnotherVolume) {
  const Capsule capsule{Vec3(0, 0, 0), Vec3(0, 2, 0), 0.5};
  const Capsule small = withVolume(capsule, 0.125 * capsule.volume());
  EXPECT_NEAR(small.volume(), 0.125 * capsule.volume(), 1e-12);
  EXPECT_NEAR(small.radius, 0.25, 1e-12);
  EXPECT_NEAR((0.5 * (small.from + small.to) - Vec3(0, 1, 0)).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace lorica
