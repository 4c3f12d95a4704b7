#include "viewer/renderer/water.h"
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

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr float kSpacing = 0.04f;

/// Drops at rest before the camera: their foremost layer fills the picture's middle just behind z = 0.
std::vector<Vec3f> block(float depth) {
  std::vector<Vec3f> drops;
  for (float z = -0.5f * kSpacing; z > -depth; z -= kSpacing) {
    for (float y = 0.5f; y < 1.5f; y += kSpacing) {
      for (float x = -0.7f; x < 0.7f; x += kSpacing) drops.emplace_back(x, y, z);
    }
  }
  return drops;
}

Scene sceneOf(const std::vector<Vec3f>& drops) {
  Scene scene;
  scene.particles = drops;
  scene.particleRadius = 0.5f * kSpacing;
  scene.particleColor = {0.0f, 0.3f, 0.6f};
  scene.water = true;
  return scene;
}

Prop boxAt(const Vec3& position, const Vec3& halfExtents) {
  Prop box;
  box.halfExtents = halfExtents;
  box.worldFromProp.translation() = position;
  box.color = {0.9f, 0.9f, 0.9f};
  return box;
}

std::array<int, 3> colorAt(const Image& image, const Vec3& position) {
  const auto [x, y] = test::seenAt(position, kWidth, kHeight);
  return test::pixelAt(image, static_cast<int>(x), static_cast<int>(y));
}

double linear(int value) {
  const double v = value / 255.0;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

/// What passes falls by the same factor for each length of the way (Beer and Lambert); this water passes exp(-5) of the
/// red light in a metre, and scatters none.
TEST(Water, DimsWhatIsBehindItByItsThickness) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const std::vector<Vec3f> drops = block(1.0f);
  Scene scene = sceneOf(drops);
  const std::vector<Prop> props = {boxAt({-0.3, 1, -0.3}, Vec3::Constant(0.1)),
                                   boxAt({0.3, 1, -0.5}, Vec3::Constant(0.1))};
  scene.props = props;
  SceneOptions options;
  options.ground = false;
  const Image image = studio->draw(scene, options, test::frontCamera(), kWidth, kHeight);
  const double near = linear(colorAt(image, {-0.3, 1, -0.2})[0]), far = linear(colorAt(image, {0.3, 1, -0.4})[0]);
  EXPECT_NEAR(far / near, std::exp(-5.0 * 0.2), 0.08) << near << " " << far;
}

TEST(WaterCells, CountAsMuchWaterAsThereIs) {
  // 0.4 m of it, 10 m away, before an eye that sees 2 m by 2 m at a depth of 10 m.
  std::vector<Vec3f> drops;
  for (float z = 9.82f; z < 10.2f; z += kSpacing) {
    for (float y = -1.18f; y < 1.2f; y += kSpacing) {
      for (float x = -1.18f; x < 1.2f; x += kSpacing) drops.emplace_back(x, y, z);
    }
  }
  GrainView view;
  view.clipFromWorld = Eigen::Vector4f(10, 10, 0, 0).asDiagonal();
  view.clipFromWorld(3, 2) = 1.0f;
  view.depthFromWorld << 0.0f, 0.0f, 1.0f, 0.0f;
  view.columns = view.rows = 30;
  GrainList list;
  WaterCells cells;
  const std::vector<std::uint32_t>& chosen = list.choose(drops, view, 0.1f);
  cells.make(drops, {}, chosen, list, view, kSpacing, Eigen::Vector2f::Constant(0.2f * kBeside));
  double mean = 0.0;
  for (const float thickness : cells.thickness()) mean += thickness / cells.thickness().size();
  EXPECT_NEAR(mean, 0.4, 0.02);
}

TEST(Water, IsAsFlatAsItsDrops) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const std::vector<Vec3f> drops = block(0.3f);
  const Image water = studio->draw(sceneOf(drops), {}, test::frontCamera(), kWidth, kHeight);
  Scene balls = sceneOf(drops);
  balls.water = false;
  const Image rough = studio->draw(balls, {}, test::frontCamera(), kWidth, kHeight);
  const auto span = [](const Image& image) {
    int low = 255, high = 0;
    for (double x = -0.4; x <= 0.4; x += 0.01) {
      const int green = colorAt(image, {x, 1, 0})[1];
      low = std::min(low, green);
      high = std::max(high, green);
    }
    return high - low;
  };
  EXPECT_LT(span(water), 16);
  EXPECT_GT(span(rough), 60) << "balls have a bright and a dark side";
}

TEST(Water, BehindSomethingIsNotSeen) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const std::vector<Vec3f> drops = block(0.3f);
  const std::vector<Prop> wall = {boxAt({0, 1, 0.2}, {1.5, 1.5, 0.05})};
  Scene scene;
  scene.props = wall;
  SceneOptions options;
  options.ground = false;
  const Image alone = studio->draw(scene, options, test::frontCamera(), kWidth, kHeight);
  Scene wet = sceneOf(drops);
  wet.props = wall;
  const Image both = studio->draw(wet, options, test::frontCamera(), kWidth, kHeight);
  // The area that shadows reach follows the drops, the rest is the same.
  EXPECT_EQ(test::differingPixels(alone, both, 4), 0);
}

TEST(Water, FoamsWhereItsDropsDoNotMoveTogether) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const std::vector<Vec3f> drops = block(0.3f);
  Scene scene = sceneOf(drops);
  const auto redWith = [&](const std::vector<Vec3f>& velocities) {
    scene.particleVelocities = velocities;
    return colorAt(studio->draw(scene, {}, test::frontCamera(), kWidth, kHeight), {0, 1, 0})[0];
  };
  const int still = redWith({});
  EXPECT_EQ(redWith(std::vector<Vec3f>(drops.size(), Vec3f(0, -3, 0))), still) << "falls as a whole";
  std::vector<Vec3f> wild(drops.size());
  for (std::size_t i = 0; i < wild.size(); ++i) wild[i] = Vec3f(i % 2 == 0 ? 3.0f : -3.0f, 0, 0);
  EXPECT_GT(redWith(wild), still + 60);
}

TEST(Water, LetsThroughWhatAPictureIsLaidOver) {
  LORICA_REQUIRE_STUDIO(studio, "");
  SceneOptions options;
  options.ground = false;
  options.transparent = true;
  const auto alphaOf = [&](float depth) {
    const std::vector<Vec3f> drops = block(depth);
    Image image = studio->draw(sceneOf(drops), options, test::frontCamera(), kWidth, kHeight);
    EXPECT_EQ(image.pixel(5, 5)[3], 0);
    return image.pixel(kWidth / 2, kHeight / 2)[3];
  };
  const int thin = alphaOf(0.08f), thick = alphaOf(0.8f);
  // 8 cm pass exp(-0.4), exp(-0.2) and exp(-0.115) of red, green and blue.
  EXPECT_NEAR(thin, 255.0 * (1.0 - (std::exp(-0.4) + std::exp(-3.6 * 0.7 * 0.08) + std::exp(-3.6 * 0.4 * 0.08)) / 3.0),
              30.0);
  EXPECT_GT(thick, thin + 80);
}

TEST(Water, IsDrawnAsBallsInTheLowestQuality) {
  LORICA_REQUIRE_STUDIO(studio, "");
  studio->setQuality(RenderQuality::kLow);
  const std::vector<Vec3f> drops = block(0.3f);
  Scene scene = sceneOf(drops);
  const Image asked = studio->draw(scene, {}, test::frontCamera(), kWidth, kHeight);
  scene.water = false;
  EXPECT_EQ(asked.rgba, studio->draw(scene, {}, test::frontCamera(), kWidth, kHeight).rgba);
}

constexpr int kGrainsWidth = 240;
constexpr int kGrainsHeight = 180;

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
  const Image empty = studio->draw({}, options, test::frontCamera(), kGrainsWidth, kGrainsHeight);
  const double perMetre = test::seenAt({1, 1, 0}, kGrainsWidth, kGrainsHeight)[0] - 0.5 * kGrainsWidth;
  for (const float radius : {0.01f, 0.03f, 0.15f}) {
    const std::vector<Vec3f> one = {Vec3f(0.0f, 1.0f, 0.0f) - radius * lookOfGrain(0).shift};
    Scene scene;
    scene.particles = one;
    scene.particleRadius = radius;
    scene.particleColor = {0.05f, 0.02f, 0.02f};
    const Image image = studio->draw(scene, options, test::frontCamera(), kGrainsWidth, kGrainsHeight);
    const double r = lookOfGrain(0).size * radius * perMetre;
    int covered = 0;
    for (int y = 0; y < kGrainsHeight; ++y) {
      for (int x = 0; x < kGrainsWidth; ++x) {
        if (std::abs(test::pixelAt(image, x, y)[0] - test::pixelAt(empty, x, y)[0]) < 60) continue;
        EXPECT_LT(std::hypot(x + 0.5 - 0.5 * kGrainsWidth, y + 0.5 - 0.5 * kGrainsHeight), 1.42 * r + 1.0);
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
  const Image image = studio->draw(scene, {}, test::frontCamera(), kGrainsWidth, kGrainsHeight);
  // Radius of the circle in which the ball intersects the plane z = 0: sqrt(0.2^2 - 0.12^2) = 0.16.
  for (const auto& [x, ball] : {std::pair{0.0, true}, {0.14, true}, {0.18, false}}) {
    const auto [u, v] = test::seenAt({x, 1.0, 0.0}, kGrainsWidth, kGrainsHeight);
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
  const Image wall = studio->draw(scene, options, test::frontCamera(), kGrainsWidth, kGrainsHeight);
  for (int i = 0; i < 3000; ++i) {
    grains.emplace_back(0.2f * std::sin(static_cast<float>(i)), 1.0f + 0.2f * std::sin(1.7f * static_cast<float>(i)),
                        -0.2f - 0.0001f * static_cast<float>(i));
  }
  scene.particles = grains;
  // Their positions change the light's area slightly, but not the visible result.
  EXPECT_LT(
      test::differingPixels(wall, studio->draw(scene, options, test::frontCamera(), kGrainsWidth, kGrainsHeight), 40),
      kGrainsWidth * kGrainsHeight / 200);
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
  const Image high = studio->draw(scene, {}, test::frontCamera(), kGrainsWidth, kGrainsHeight);
  for (const RenderQuality quality : {RenderQuality::kMedium, RenderQuality::kLow}) {
    studio->setQuality(quality);
    const Image image = studio->draw(scene, {}, test::frontCamera(), kGrainsWidth, kGrainsHeight);
    ASSERT_EQ(image.width, kGrainsWidth);
    EXPECT_GT(test::differingPixels(high, image, 8), 0);
    EXPECT_LT(test::differingPixels(high, image, 64), kGrainsWidth * kGrainsHeight / 50);
  }
  studio->setQuality(RenderQuality::kHigh);
  EXPECT_EQ(studio->draw(scene, {}, test::frontCamera(), kGrainsWidth, kGrainsHeight).rgba, high.rgba);
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
    const Image image = studio->draw(scene, {}, test::frontCamera(), kGrainsWidth, kGrainsHeight);
    const auto [x, y] = test::seenAt(position, kGrainsWidth, kGrainsHeight);
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
