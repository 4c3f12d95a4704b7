#include "collision/world/live_obstacles.h"

#include "session/scenes/scene_file.h"
#include "skinning/linear_blend.h"
#include "tests/session/haired_box.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

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

Result<SceneFile> sceneWith(const std::string& particles) {
  return parseScene("{\"format\": \"lorica scene 1\", " + particles + "}", "my.json");
}

TEST(SceneParticles, AreReadPouredAndSettle) {
  const SceneFile scene = test::valueOf(sceneWith(
      R"("gravity": [0, -5, 0], "grains": {"radius": 0.02, "settle": 0.5, "color": "#ffffff",
         "fill": [{"at": [0, 0.1, 0], "size": [0.4, 0.2, 0.4], "count": 50}],
         "pour": [{"at": [0, 1, 0], "radius": 0.1, "rate": 300, "count": 200}]})"));
  ASSERT_TRUE(scene.particles.has_value());
  EXPECT_DOUBLE_EQ(scene.particles->gravity.y(), -5.0);
  EXPECT_EQ(scene.particles->color, Vec3f::Ones());
  World world = makeWorld(scene).value();
  ASSERT_NE(world.particles(), nullptr);
  EXPECT_EQ(world.particles()->positions().size(), 50u);
  world.step({}, 1.0 / 30.0);
  EXPECT_EQ(world.particles()->positions().size(), 210u) << "half a second and a frame of pouring";
  for (int i = 0; i < 10; ++i) world.step({}, 1.0 / 30.0);
  EXPECT_EQ(world.particles()->positions().size(), 250u) << "not more than requested";
}

/// The times at which particles cross a height, from their positions in each frame, in ascending order [s].
std::vector<double> arrivals(World& world, float height, int frames, double frame) {
  std::vector<double> times;
  std::vector<float> before;
  for (int f = 0; f < frames; ++f) {
    world.step({}, frame);
    const std::span<const Vec3f> now = world.particles()->positions();
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (before[i] <= height || now[i].y() > height) continue;
      times.push_back((f + (before[i] - height) / (before[i] - now[i].y())) * frame);
    }
    before.clear();
    for (const Vec3f& p : now) before.push_back(p.y());
  }
  std::sort(times.begin(), times.end());
  return times;
}

TEST(SceneParticles, APourIsAStreamAtAnyHeight) {
  for (const char* kind : {R"("grains": {"radius": 0.005,)", R"("water": {"spacing": 0.01, "viscosity": 0,)"}) {
    for (const char* velocity : {"[0, -2.5, 0]", "[0, -0.5, 0]"}) {
      const SceneFile scene = test::valueOf(sceneWith(
          std::string(kind) + R"("pour": [{"at": [0, 3, 0], "radius": 0.3, "rate": 1000, "count": 1000, "velocity": )" +
          velocity + "}]}"));
      for (const float height : {2.8f, 1.5f}) {
        World world = makeWorld(scene).value();
        const std::vector<double> times = arrivals(world, height, 30, 1.0 / 30.0);
        ASSERT_GE(times.size(), 250u);
        // One in each millisecond; a pour in slabs leaves gaps that are a good part of a frame.
        double longest = 0.0;
        for (std::size_t i = 1; i < times.size(); ++i) longest = std::max(longest, times[i] - times[i - 1]);
        EXPECT_LT(longest, 0.005) << kind << velocity << ", through " << height << " m";
      }
    }
  }
}

TEST(SceneParticles, WaterStaysBetweenWalls) {
  const SceneFile scene = test::valueOf(sceneWith(
      R"("water": {"spacing": 0.05, "walls": {"from": [-0.3, 0, -0.3], "to": [0.3, 0, 0.3]},
         "fill": [{"at": [0, 0.3, 0], "size": [0.5, 0.5, 0.5]}]})"));
  World world = makeWorld(scene).value();
  for (int i = 0; i < 30; ++i) world.step({}, 1.0 / 30.0);
  EXPECT_GT(world.particles()->positions().size(), 500u);
  for (const Vec3f& p : world.particles()->positions()) {
    EXPECT_LE(std::abs(p.x()), 0.3f);
    EXPECT_LE(std::abs(p.z()), 0.3f);
  }
}

TEST(SceneParticles, MistakesAreNamed) {
  const auto sentence = [](const std::string& particles) { return sceneWith(particles).error().message; };
  EXPECT_EQ(sentence(R"("grains": {"radius": 0, "fill": []})"),
            "my.json: grains.radius: found 0, expected a number from 0.004 to 0.1");
  EXPECT_EQ(sentence(R"("grains": {})"),
            "my.json: grains.fill: found nothing, expected a list of boxes, or a list \"pour\"");
  EXPECT_EQ(sentence(R"("grains": {"pour": [{"at": [0, 1, 0], "count": 9000000}]})"),
            "my.json: grains.pour[0].count: found 9000000, expected a whole number from 1 to 300000");
  EXPECT_NE(sentence(R"("grains": {"fill": [{"at": [0, 1, 0], "size": [1, 1, 1]}]}, "water": {})").find("one of them"),
            std::string::npos);
  EXPECT_NE(sentence(R"("water": {"friction": 1})").find("water.friction: found no such key"), std::string::npos);
}

}  // namespace
}  // namespace lorica
