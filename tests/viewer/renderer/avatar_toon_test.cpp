// MToon by its formulas: https://github.com/vrm-c/vrm-specification, VRMC_materials_mtoon-1.0.

#include "tests/viewer/renderer/avatars.h"
#include "tests/viewer/renderer/pictures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica {
namespace {

constexpr int kWidth = 240;
constexpr int kHeight = 180;
using test::AvatarMaker;
using test::AvatarOnStage;
using test::byteOf;
using test::dark;
using test::onBlack;
using test::towardsLight;

const Vec3 kLit(0.8, 0.5, 0.4), kShade(0.3, 0.1, 0.2);

Material toon() {
  Material material;
  material.shading = Shading::kToon;
  material.baseColor << kLit.cast<float>(), 1.0f;
  material.toon.shadeColor = kShade.cast<float>();
  return material;
}

AvatarLight keyOnly(float key) {
  AvatarLight light = dark();
  light.key = Vec3f::Constant(key);
  return light;
}

std::array<int, 3> middleOf(test::Studio& studio, const AvatarMaker& maker, const AvatarLight& light,
                            double time = 0.0) {
  Scene scene;
  const AvatarOnStage stage(maker.avatar);
  scene = stage.scene();
  scene.time = time;
  return test::pixelAt(studio.draw(scene, onBlack(light), test::frontCamera(), kWidth, kHeight), kWidth / 2,
                       kHeight / 2);
}

/// A square with this normal.
AvatarMaker squareOf(const Material& material, const Vec3& normal = Vec3::UnitZ()) {
  AvatarMaker maker;
  maker.material(material);
  AvatarMaker::Quad quad;
  quad.normal = normal.cast<float>();
  maker.add(quad);
  return maker;
}

void expectColor(const std::array<int, 3>& found, const Vec3& linear, int tolerance, const std::string& what) {
  for (Eigen::Index c = 0; c < 3; ++c) EXPECT_NEAR(found[c], byteOf(linear[c]), tolerance) << what;
}

TEST(AvatarToon, TheBorderBetweenLightAndShadeFollowsShiftAndToony) {
  LORICA_REQUIRE_STUDIO(studio, "");
  for (const double toony : {0.0, 0.5, 0.9}) {
    for (const double shift : {-0.4, 0.0, 0.3}) {
      for (const double cosine : {-0.9, -0.3, -0.05, 0.0, 0.05, 0.3, 0.9}) {
        const Vec3 l = towardsLight();
        const Vec3 across = l.cross(Vec3::UnitX()).normalized();
        Material material = toon();
        material.toon.toony = static_cast<float>(toony);
        material.toon.shift = static_cast<float>(shift);
        const AvatarMaker maker = squareOf(material, cosine * l + std::sqrt(1.0 - cosine * cosine) * across);
        const double lit = std::clamp((cosine + shift + 1.0 - toony) / (2.0 - 2.0 * toony), 0.0, 1.0);
        expectColor(middleOf(*studio, maker, keyOnly(0.9f)), 0.9 * (kShade + lit * (kLit - kShade)), 2,
                    "toony " + std::to_string(toony) + ", shift " + std::to_string(shift) + ", cosine " +
                        std::to_string(cosine));
      }
    }
  }
}

TEST(AvatarToon, TheShiftTextureAddsItsRedTimesItsScale) {
  LORICA_REQUIRE_STUDIO(studio, "");
  Material material = toon();
  material.toon.toony = 0.0f;
  material.toon.shift = -0.8f;
  material.toon.shiftScale = 0.5f;
  AvatarMaker maker;
  material.toon.shiftTexture = maker.picture({102, 255, 255, 255});
  maker.material(material);
  maker.add({});
  const double lit = 0.5 * (towardsLight().z() - 0.8 + 0.5 * 0.4) + 0.5;
  expectColor(middleOf(*studio, maker, keyOnly(1.0f)), kShade + lit * (kLit - kShade), 2, "");
}

TEST(AvatarToon, TheShadeTextureIsAColor) {
  LORICA_REQUIRE_STUDIO(studio, "");
  Material material = toon();
  material.toon.shift = -1.0f;
  AvatarMaker maker;
  material.toon.shade = maker.picture({255, 188, 100, 255});
  maker.material(material);
  maker.add({});
  expectColor(middleOf(*studio, maker, keyOnly(1.0f)),
              kShade.cwiseProduct(Vec3(1.0, test::linearOf(188), test::linearOf(100))), 2, "");
}

TEST(AvatarToon, AmbientLightFollowsTheNormalsHeightAndNeverExceedsTheLitColor) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarLight light = dark();
  light.sky = Vec3f(0.2f, 0.4f, 0.6f);
  light.ground = Vec3f(0.3f, 0.1f, 0.0f);
  for (const double even : {0.0, 0.4, 1.0}) {
    for (const double up : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
      Material material = toon();
      material.toon.giEqualization = static_cast<float>(even);
      const AvatarMaker maker = squareOf(material, Vec3(0.0, up, std::sqrt(1.0 - up * up)));
      const Vec3 sky = light.sky.cast<double>(), ground = light.ground.cast<double>();
      const Vec3 raw = ground + (sky - ground) * (0.5 + 0.5 * up);
      const Vec3 around = raw + even * (0.5 * (sky + ground) - raw);
      expectColor(middleOf(*studio, maker, light), around.cwiseProduct(kLit), 2,
                  "evened out by " + std::to_string(even) + ", up " + std::to_string(up));
    }
  }
  light.key = light.sky = light.ground = Vec3f::Constant(3.0f);
  expectColor(middleOf(*studio, squareOf(toon(), towardsLight()), light), kLit, 2, "strong light");
}

TEST(AvatarToon, TheRimGrowsTowardsTheEdge) {
  LORICA_REQUIRE_STUDIO(studio, "");
  for (const double power : {1.0, 3.0}) {
    for (const double lift : {0.0, 0.2}) {
      for (const double mix : {0.0, 1.0}) {
        Material material = toon();
        material.baseColor = {0, 0, 0, 1};
        material.toon.shadeColor.setZero();
        material.toon.rimColor = {0.6f, 0.3f, 0.1f};
        material.toon.rimPower = static_cast<float>(power);
        material.toon.rimLift = static_cast<float>(lift);
        material.toon.rimLightingMix = static_cast<float>(mix);
        AvatarMaker maker;
        material.toon.rim = maker.picture({255, 255, 188, 255});
        maker.material(material);
        AvatarMaker::Quad quad;
        quad.normal = Vec3f(0.8f, 0.0f, 0.6f);
        maker.add(quad);
        const double light = 1.0 + mix * (0.5 - 1.0);
        const Vec3 rim = light * std::pow(1.0 - 0.6 + lift, power) * Vec3(0.6, 0.3, 0.1 * test::linearOf(188));
        expectColor(middleOf(*studio, maker, keyOnly(0.5f)), rim, 2, "power " + std::to_string(power));
      }
    }
  }
}

TEST(AvatarToon, TheMatcapIsFoundByTheNormalOnScreen) {
  LORICA_REQUIRE_STUDIO(studio, "");
  // Four colours: a normal to the upper left meets the upper left texel.
  const std::vector<std::array<std::uint8_t, 4>> four = {
      {255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 255, 255}};
  for (std::size_t i = 0; i < four.size(); ++i) {
    AvatarMaker maker;
    Material material = toon();
    material.baseColor = {0, 0, 0, 1};
    material.toon.shadeColor.setZero();
    material.toon.rimLightingMix = 0.0f;
    material.toon.matcap = maker.picture(2, 2, four);
    material.toon.matcapFactor = {0.5f, 0.5f, 0.5f};
    maker.material(material);
    AvatarMaker::Quad quad;
    quad.normal = Vec3f(i % 2 == 0 ? -0.5f : 0.5f, i < 2 ? 0.5f : -0.5f, 0.7071f);
    maker.add(quad);
    expectColor(middleOf(*studio, maker, dark()), 0.5 * Vec3(four[i][0], four[i][1], four[i][2]) / 255.0, 1,
                std::to_string(i));
  }
}

TEST(AvatarToon, TexturesMoveWithTime) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarMaker maker;
  Material material = toon();
  material.baseColor = {1, 1, 1, 1};
  material.toon.shift = 1.0f;
  material.base = maker.picture(4, 1, {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 255, 255}});
  material.base.wrapU = TextureWrap::kRepeat;
  material.toon.uvScroll = {0.25f, 0.0f};
  maker.material(material);
  AvatarMaker::Quad quad;
  quad.uLeft = quad.uRight = 0.125f;  // red at first
  maker.add(quad);
  const std::array<Vec3, 5> expected = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 1, 1), Vec3(1, 0, 0)};
  for (int second = 0; second < 5; ++second) {
    expectColor(middleOf(*studio, maker, keyOnly(1.0f), second), expected[second], 0, std::to_string(second));
  }
}

/// Number of red pixels to the left of the middle.
int redToTheLeft(const Image& image) {
  int count = 0;
  for (int x = 0; x < image.width / 2; ++x) {
    const auto pixel = test::pixelAt(image, x, image.height / 2);
    count += pixel[0] > 128 && pixel[1] < 64;
  }
  return count;
}

TEST(AvatarToon, OutlinesAreAsWideAsTheySay) {
  LORICA_REQUIRE_STUDIO(studio, "");
  constexpr int kLargeHeight = 600;
  const double focal = 0.5 * kLargeHeight / std::tan(0.5 * test::frontCamera().verticalFov);
  for (const OutlineMode mode : {OutlineMode::kWorld, OutlineMode::kScreen}) {
    for (const double distance : {4.0, 8.0}) {
      AvatarMaker maker;
      Material material = toon();
      material.toon.outline = mode;
      material.toon.outlineWidth = 0.04f;
      material.toon.outlineColor = {1, 0, 0};
      material.toon.outlineLightingMix = 0.0f;
      maker.material(material);
      maker.addSphere({0, 1, 0}, 0.4, 96, 128);
      Camera camera = test::frontCamera();
      camera.eye.z() = distance;
      const AvatarOnStage stage(maker.avatar);
      const Image image = studio->draw(stage.scene(), onBlack(), camera, kLargeHeight, kLargeHeight);
      const auto seenRadius = [&](double radius) {
        return focal * radius / std::sqrt(distance * distance - radius * radius);
      };
      // A screen's unit is half of the picture's height.
      const double expected = mode == OutlineMode::kWorld ? seenRadius(0.44) - seenRadius(0.4) : 0.02 * kLargeHeight;
      EXPECT_NEAR(redToTheLeft(image), expected, 1.3) << "distance " << distance;
    }
  }
}

TEST(AvatarToon, OutlinesTakeTheirWidthFromATextureAndTheirColorFromTheLight) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const auto look = [&](std::uint8_t green, float width, float mix) {
    AvatarMaker maker;
    Material material = toon();
    material.toon.outline = OutlineMode::kWorld;
    material.toon.outlineWidth = width;
    material.toon.outlineColor = {1, 0, 0};
    material.toon.outlineLightingMix = mix;
    material.toon.outlineWidthTexture = maker.picture({0, green, 0, 255});
    maker.material(material);
    maker.addSphere({0, 1, 0}, 0.4, 96, 128);
    return studio->draw(AvatarOnStage(maker.avatar).scene(), onBlack(keyOnly(0.9f)), test::frontCamera(), kWidth,
                        kHeight);
  };
  EXPECT_LT(test::differingPixels(look(51, 0.1f, 0.0f), look(255, 0.02f, 0.0f), 40), 20);
  EXPECT_EQ(redToTheLeft(look(0, 0.1f, 0.0f)), 0);
  // Lit, the outline is its colour times the shade of a surface that faces away, which the left edge is.
  const Image lit = look(255, 0.1f, 1.0f);
  int brightest = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto pixel = test::pixelAt(lit, x, y);
      if (pixel[1] == 0) brightest = std::max(brightest, pixel[0]);
    }
  }
  EXPECT_NEAR(brightest, byteOf(0.9 * kLit.x()), 2);
}

TEST(AvatarToon, BlendedSurfacesHaveTheirOutlineBehindThem) {
  LORICA_REQUIRE_STUDIO(studio, "");
  for (const float alpha : {0.6f, 0.4f}) {
    AvatarMaker maker;
    Material material = toon();
    material.alpha = AlphaMode::kBlend;
    material.baseColor = {0.0f, 1.0f, 0.0f, alpha};
    material.toon.shadeColor = {0.0f, 1.0f, 0.0f};
    material.toon.outline = OutlineMode::kWorld;
    material.toon.outlineWidth = 0.04f;
    material.toon.outlineColor = {1, 0, 0};
    material.toon.outlineLightingMix = 0.0f;
    maker.material(material);
    maker.addSphere({0, 1, 0}, 0.4, 96, 128);
    const AvatarOnStage stage(maker.avatar);
    const Image image = studio->draw(stage.scene(), onBlack(keyOnly(1.0f)), test::frontCamera(), 600, 600);
    const auto middle = test::pixelAt(image, 300, 300);
    // What is more opaque than not hides the outline behind it.
    EXPECT_NEAR(middle[0], alpha > 0.5f ? 0.0f : 255.0f * alpha * (1.0f - alpha), 2);
    EXPECT_NEAR(middle[1], 255.0f * alpha, 2);
    const double focal = 300.0 / std::tan(0.5 * test::frontCamera().verticalFov);
    const double distance = test::frontCamera().eye.z();
    const int beside = static_cast<int>(focal * 0.42 / std::sqrt(distance * distance - 0.42 * 0.42));
    const auto outline = test::pixelAt(image, 300 - beside, 300);
    EXPECT_NEAR(outline[0], 255.0f * alpha, 2);
    EXPECT_EQ(outline[1], 0);
  }
}

}  // namespace
}  // namespace lorica
