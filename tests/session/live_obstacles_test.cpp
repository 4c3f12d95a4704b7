#include "collision/world/live_obstacles.h"

#include "skinning/linear_blend.h"
#include "tests/session/haired_box.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

namespace lorica {
namespace {

constexpr double kRadius = 0.03;

/// The obstacles of the haired box, at rest, with props around it.
struct AtRest {
  explicit AtRest(std::vector<Prop> all = {}) : props(std::move(all)) {
    std::vector<Affine3> worldFromJoint(4);
    computeWorldFromJoint(character.skeleton, restPose(character.skeleton), worldFromJoint);
    computeWorldFromModel(character, worldFromJoint, worldFromModel);
    body.update(worldFromModel);
    obstacles.prepare(body.parts(), worldFromModel, worldFromModel, props, 0.1);
    obstacles.moveTo(1.0);
  }
  Character character = test::hairedBox();
  LiveBody body = LiveBody::create(test::hairedBoxParts(), character).value();
  SpringSimulation springs =
      SpringSimulation::create(character.skeleton, test::hairedBoxSprings({.hitRadius = kRadius})).value();
  LiveObstacles obstacles{body, character, springs};
  std::vector<Affine3> worldFromModel = std::vector<Affine3>(4);
  std::vector<Prop> props;
};

Vec3 randomVector(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  const double x = uniform(random);
  const double y = uniform(random);
  return {x, y, uniform(random)};
}

/// Distance of a point from a prop by trying many points of its surface and inside: slow, and a little too large.
double distanceByTrying(const Prop& prop, const Vec3& point) {
  const auto inside = [&](const Vec3& p) {
    const Vec3 half = prop.halfExtents;
    const double across = std::hypot(p.x(), p.z());
    switch (prop.shape) {
      case PropShape::kBox:
      case PropShape::kMesh:  // a box too
        return (p.cwiseAbs() - half).maxCoeff() <= 0.0;
      case PropShape::kSphere:
        return p.norm() <= half.x();
      case PropShape::kCapsule:
        return std::hypot(across, std::max(0.0, std::abs(p.y()) - (half.y() - half.x()))) <= half.x();
      case PropShape::kCylinder:
        return across <= half.x() && std::abs(p.y()) <= half.y();
    }
    return false;
  };
  constexpr int kSteps = 60;
  const Vec3 local = prop.worldFromProp.inverse() * point;
  double least = kInfinity;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      for (int k = 0; k <= kSteps; ++k) {
        const Vec3 p = (Vec3(i, j, k) * (2.0 / kSteps) - Vec3::Ones()).cwiseProduct(prop.halfExtents);
        if (inside(p)) least = std::min(least, (p - local).norm());
      }
    }
  }
  return least;
}

TEST(LiveObstacles, TailsLeavePropsOfEveryShape) {
  std::mt19937 random(5);
  for (int shape = 0; shape <= kPropShapeCount; ++shape) {
    Prop prop;
    prop.shape = static_cast<PropShape>(shape);
    prop.halfExtents = shape == 1 ? Vec3(Vec3::Constant(0.1)) : Vec3(0.1, 0.15, shape == 0 ? 0.05 : 0.1);
    if (prop.shape == PropShape::kMesh) {
      auto mesh = std::make_shared<PropMeshShape>();
      mesh->hulls = {convexHull(test::makeBox(-prop.halfExtents, prop.halfExtents).vertices)};
      prop.mesh = mesh;
    }
    prop.worldFromProp.linear() = Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
    prop.worldFromProp.translation() = Vec3(3.0, 1.0, 0.0);
    AtRest at({prop});
    int pushed = 0;
    for (int i = 0; i < 40; ++i) {
      const Vec3 head = prop.worldFromProp * (0.24 * randomVector(random, 1.0).normalized());
      const Vec3 aimed = prop.worldFromProp * randomVector(random, 0.1);
      Vec3 tail = head + 0.2 * (aimed - head).normalized();
      const Vec3 before = tail;
      at.obstacles.pushOut(0, head, 0.2, tail);
      EXPECT_NEAR((tail - head).norm(), 0.2, 1e-9);
      // A corner of a mesh is measured from its planes; the others exactly, but for the grid of the slow way.
      EXPECT_GT(distanceByTrying(prop, tail), kRadius - 1e-6) << "shape " << shape;
      pushed += (tail - before).norm() > 1e-6 ? 1 : 0;
      if (pushed == 0) continue;
      EXPECT_TRUE((tail - before).norm() > 1e-6 || distanceByTrying(prop, before) > kRadius - 1e-6);
    }
    EXPECT_GT(pushed, 20) << "shape " << shape;
  }
}

TEST(LiveObstacles, PropsMoveOnWithTheirVelocity) {
  Prop ball;
  ball.shape = PropShape::kSphere;
  ball.halfExtents.setConstant(0.1);
  ball.worldFromProp.translation() = Vec3(3.0, 1.0, 0.0);
  ball.velocity = Vec3(2.0, 0.0, 0.0);
  AtRest at({ball});
  Vec3 first = Vec3::Zero();
  for (const double share : {0.0, 0.5, 1.0}) {
    at.obstacles.moveTo(share);
    const Vec3 center = Vec3(3.0 + 0.2 * share, 1.0, 0.0);
    Vec3 tail = center + Vec3(0.0, 0.05, 0.05);
    at.obstacles.pushOut(0, center + Vec3(0.0, 0.2, 0.0), 0.2, tail);
    EXPECT_GE((tail - center).norm(), 0.1 + kRadius - 1e-6) << share;
    EXPECT_LT((tail - center).norm(), 0.15) << share;
    if (share == 0.0) first = tail - center;
    EXPECT_NEAR((tail - center - first).norm(), 0.0, 1e-9) << share;
  }
}

TEST(LiveObstacles, StaticPropsDoNotCount) {
  Prop wall;
  wall.mass = 0.0;
  wall.worldFromProp.translation() = Vec3(3.0, 1.0, 0.0);
  AtRest at({wall});
  Vec3 tail(3.0, 1.0, 0.0);
  at.obstacles.pushOut(0, Vec3(3.0, 1.2, 0.0), 0.2, tail);
  EXPECT_EQ(tail, Vec3(3.0, 1.0, 0.0));
}

TEST(LiveObstacles, APartThatSpringsMoveIsNone) {
  const AtRest at;
  EXPECT_FALSE(at.obstacles.distance(0, 1, Vec3::Zero()));
  ASSERT_TRUE(at.obstacles.distance(0, 0, Vec3::Zero()));
  EXPECT_NEAR(*at.obstacles.distance(0, 0, Vec3(0.3, 1.0, 0.0)), 0.1, 1e-6);
  EXPECT_NEAR(*at.obstacles.distance(0, 0, Vec3(0.15, 1.0, 0.0)), -0.05, 1e-6);
}

TEST(LiveObstacles, TailsLeaveTheHullOfTheBody) {
  std::mt19937 random(6);
  AtRest at;
  int pushed = 0;
  for (int i = 0; i < 500; ++i) {
    // Heads up to 5 cm inside, tails anywhere within reach.
    const Vec3 head = Vec3(0.15 + 0.1 * std::abs(randomVector(random, 1.0).x()), 1.0, 0.0) + randomVector(random, 0.1);
    Vec3 tail = head + 0.2 * randomVector(random, 1.0).normalized();
    const double before = *at.obstacles.distance(0, 0, tail);
    at.obstacles.pushOut(0, head, 0.2, tail);
    EXPECT_NEAR((tail - head).norm(), 0.2, 1e-9);
    EXPECT_GE(*at.obstacles.distance(0, 0, tail), std::min(before, kRadius - 1e-6));
    if (before >= kRadius) continue;
    EXPECT_GE(*at.obstacles.distance(0, 0, tail), kRadius - 1e-6);
    ++pushed;
  }
  EXPECT_GT(pushed, 100);
}

}  // namespace
}  // namespace lorica
