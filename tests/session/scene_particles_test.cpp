#include "session/scenes/scene_file.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

namespace lorica {
namespace {

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
  World world = makeWorld(scene);
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
        World world = makeWorld(scene);
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
  World world = makeWorld(scene);
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
