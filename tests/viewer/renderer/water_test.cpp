#include "viewer/renderer/water.h"
#include "tests/viewer/renderer/pictures.h"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace lorica
