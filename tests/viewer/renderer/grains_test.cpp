#include "tests/support/meshes.h"
#include "tests/viewer/renderer/pictures.h"
#include "viewer/renderer/grain_list.h"
#include "viewer/renderer/prop_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

namespace lorica {
namespace {

constexpr int kWidth = 240;
constexpr int kHeight = 180;

/// A view along -Z of a 2 m square around the origin.
GrainView flatView(int cells) {
  GrainView view;
  view.clipFromWorld = Eigen::Matrix4f::Identity();
  view.depthFromWorld << 0.0f, 0.0f, -1.0f, 0.0f;
  view.columns = view.rows = cells;
  return view;
}

TEST(GrainList, WhatIsBehindAnotherInItsCellIsLeftOut) {
  const std::vector<Vec3f> centers = {
      {0.01f, 0.01f, 0.0f}, {0.02f, 0.01f, 0.5f}, {0.02f, 0.02f, 0.45f}, {0.5f, 0.5f, 0.0f}};
  GrainList list;
  // 2 is within the margin, 3 in its own cell.
  EXPECT_EQ(list.choose(centers, flatView(10), 0.1f), (std::vector<std::uint32_t>{1, 2, 3}));
  EXPECT_EQ(list.choose(centers, flatView(10), std::numeric_limits<float>::infinity()).size(), 4u);
}

TEST(GrainList, WhatIsOutsideOrNotFiniteIsLeftOut) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<Vec3f> centers = {{1.2f, 0, 0}, {0, -1.2f, 0}, {nan, 0, 0}, {0, inf, 0}, {0.9f, 0.9f, 0}};
  GrainList list;
  EXPECT_EQ(list.choose(centers, flatView(7), 0.1f), std::vector<std::uint32_t>{4});
}

TEST(GrainList, GrainsDifferALittle) {
  double brightness = 0.0, size = 0.0;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const GrainLook look = lookOfGrain(i);
    EXPECT_NEAR(look.brightness, 1.0f, 0.2f);
    EXPECT_NEAR(look.size, 1.0f, 0.15f);
    EXPECT_LE(look.shift.cwiseAbs().maxCoeff(), 0.4f);
    brightness += look.brightness / 1000.0;
    size += look.size / 1000.0;
  }
  EXPECT_NEAR(brightness, 1.0, 0.02);
  EXPECT_NEAR(size, 1.0, 0.02);
}

TEST(Grains, LookLikeBallsOfTheirRadius) {
  LORICA_REQUIRE_STUDIO(studio, "");
  SceneOptions options;
  options.ground = false;
  const Image empty = studio->draw({}, options, test::frontCamera(), kWidth, kHeight);
  const double perMetre = test::seenAt({1, 1, 0}, kWidth, kHeight)[0] - 0.5 * kWidth;
  for (const float radius : {0.01f, 0.03f, 0.15f}) {
    const std::vector<Vec3f> one = {Vec3f(0.0f, 1.0f, 0.0f) - radius * lookOfGrain(0).shift};
    Scene scene;
    scene.particles = one;
    scene.particleRadius = radius;
    scene.particleColor = {0.05f, 0.02f, 0.02f};
    const Image image = studio->draw(scene, options, test::frontCamera(), kWidth, kHeight);
    const double r = lookOfGrain(0).size * radius * perMetre;
    int covered = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (std::abs(test::pixelAt(image, x, y)[0] - test::pixelAt(empty, x, y)[0]) < 60) continue;
        EXPECT_LT(std::hypot(x + 0.5 - 0.5 * kWidth, y + 0.5 - 0.5 * kHeight), 1.42 * r + 1.0);
        ++covered;
      }
    }
    EXPECT_NEAR(covered, 3.14159 * r * r, 4.0 * r + 4.0) << radius;
  }
}

TEST(Grains, BallsMeetWhereTheirDepthsSay) {
  LORICA_REQUIRE_STUDIO(studio, "");
  // A box whose front face intersects the ball: the ball is visible where it is nearer, otherwise the box.
  Prop box;
  box.halfExtents = Vec3(0.5, 0.5, 0.1);
  box.worldFromProp.translation() = Vec3(0, 1, -0.1);
  box.color = {0.05f, 0.05f, 0.8f};
  const std::vector<Prop> props = {box};
  const GrainLook look = lookOfGrain(0);
  const float radius = 0.2f / look.size;
  const std::vector<Vec3f> one = {Vec3f(0.0f, 1.0f, -0.12f) - radius * look.shift};
  Scene scene;
  scene.props = props;
  scene.particles = one;
  scene.particleRadius = radius;
  scene.particleColor = {0.8f, 0.02f, 0.02f};
  const Image image = studio->draw(scene, {}, test::frontCamera(), kWidth, kHeight);
  // Radius of the circle in which the ball intersects the plane z = 0: sqrt(0.2^2 - 0.12^2) = 0.16.
  for (const auto& [x, ball] : {std::pair{0.0, true}, {0.14, true}, {0.18, false}}) {
    const auto [u, v] = test::seenAt({x, 1.0, 0.0}, kWidth, kHeight);
    const auto pixel = test::pixelAt(image, static_cast<int>(u), static_cast<int>(v));
    EXPECT_EQ(pixel[0] > pixel[2], ball) << x;
  }
}

TEST(Grains, ManyHiddenOnesChangeNothing) {
  LORICA_REQUIRE_STUDIO(studio, "");
  // A dense wall of grains, and 3,000 behind it.
  std::vector<Vec3f> grains;
  for (int i = -30; i <= 30; ++i) {
    for (int k = -30; k <= 30; ++k)
      grains.emplace_back(0.008f * static_cast<float>(i), 1.0f + 0.008f * static_cast<float>(k), 0.0f);
  }
  Scene scene;
  scene.particleRadius = 0.008f;
  scene.particles = grains;
  SceneOptions options;
  options.ground = false;
  const Image wall = studio->draw(scene, options, test::frontCamera(), kWidth, kHeight);
  for (int i = 0; i < 3000; ++i) {
    grains.emplace_back(0.2f * std::sin(static_cast<float>(i)), 1.0f + 0.2f * std::sin(1.7f * static_cast<float>(i)),
                        -0.2f - 0.0001f * static_cast<float>(i));
  }
  scene.particles = grains;
  // Their positions change the light's area slightly, but not the visible result.
  EXPECT_LT(test::differingPixels(wall, studio->draw(scene, options, test::frontCamera(), kWidth, kHeight), 40),
            kWidth * kHeight / 200);
}

TEST(Renderer, LowerQualityShowsTheSameThings) {
  LORICA_REQUIRE_STUDIO(studio, "");
  Prop box;
  box.halfExtents = Vec3::Constant(0.3);
  box.worldFromProp.translation() = Vec3(0, 1, 0);
  box.color = {0.8f, 0.05f, 0.05f};
  const std::vector<Prop> props = {box};
  Scene scene;
  scene.props = props;
  const Image high = studio->draw(scene, {}, test::frontCamera(), kWidth, kHeight);
  for (const RenderQuality quality : {RenderQuality::kMedium, RenderQuality::kLow}) {
    studio->setQuality(quality);
    const Image image = studio->draw(scene, {}, test::frontCamera(), kWidth, kHeight);
    ASSERT_EQ(image.width, kWidth);
    EXPECT_GT(test::differingPixels(high, image, 8), 0);
    EXPECT_LT(test::differingPixels(high, image, 64), kWidth * kHeight / 50);
  }
  studio->setQuality(RenderQuality::kHigh);
  EXPECT_EQ(studio->draw(scene, {}, test::frontCamera(), kWidth, kHeight).rgba, high.rgba);
}

TEST(Renderer, PropsOfOneMeshShareItAndOthersReplaceItWhenItIsGone) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const auto prop = [](const TriMesh& mesh, const Vec3& position) {
    auto shape = std::make_shared<PropMeshShape>();
    shape->shown = mesh;
    Prop made;
    made.shape = PropShape::kMesh;
    made.mesh = shape;
    made.worldFromProp.translation() = position;
    made.color = {0.8f, 0.05f, 0.05f};
    return made;
  };
  const auto redAt = [&](const std::vector<Prop>& props, const Vec3& position) {
    Scene scene;
    scene.props = props;
    const Image image = studio->draw(scene, {}, test::frontCamera(), kWidth, kHeight);
    const auto [x, y] = test::seenAt(position, kWidth, kHeight);
    const auto pixel = test::pixelAt(image, static_cast<int>(x), static_cast<int>(y));
    return pixel[0] > 2 * pixel[1];
  };
  // A ring that faces the camera: open in the middle.
  TriMesh ring = test::makeTorus(0.3, 0.08, 24, 12);
  for (Vec3& v : ring.vertices) v = Vec3(v.x(), v.z(), -v.y());
  for (int i = 0; i < 3; ++i) {
    std::vector<Prop> two = {prop(ring, {0.5, 1, 0}), prop(test::makeSphere(0.2, 16, 24), {-0.5, 1, 0})};
    EXPECT_FALSE(redAt(two, {0.5, 1, 0}));
    EXPECT_TRUE(redAt(two, {0.8, 1, 0}));
    EXPECT_TRUE(redAt(two, {-0.5, 1, 0}));
    two[0].mesh = two[1].mesh;
    EXPECT_TRUE(redAt(two, {0.5, 1, 0}));
    EXPECT_FALSE(redAt(two, {0.8, 1, 0}));
  }
}

TEST(CreaseMesh, ABoxIsSharpAndASphereIsRound) {
  const PropMesh box = makeCreasedMesh(test::makeBox({-1, -1, -1}, {1, 1, 1}));
  ASSERT_EQ(box.vertices.size(), 36u);
  for (const PropMesh::Vertex& v : box.vertices) EXPECT_NEAR(v.normal.cwiseAbs().maxCoeff(), 1.0f, 1e-6f);
  for (const PropMesh::Vertex& v : makeCreasedMesh(test::makeSphere(0.5, 24, 32)).vertices) {
    EXPECT_GT(v.normal.dot(v.corner.normalized()), 0.99f);
    EXPECT_NEAR(v.normal.norm(), 1.0f, 1e-5f);
  }
}

}  // namespace
}  // namespace lorica
