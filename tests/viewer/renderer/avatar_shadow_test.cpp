#include "tests/viewer/renderer/avatar_squares.h"
#include "tests/viewer/renderer/avatars.h"
#include "tests/viewer/renderer/pictures.h"
#include "viewer/renderer/frame_setup.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica {
namespace {

using test::AvatarMaker;
using test::drawn;
using test::expectNear;
using test::onBlack;
using test::seen;
using test::unlit;

// Shadows of avatars: on the floor, on themselves, and none where there should be none.

constexpr int kSide = 240;
constexpr std::array kQualities = {RenderQuality::kHigh, RenderQuality::kMedium, RenderQuality::kLow};
using test::AvatarMaker;
using test::AvatarOnStage;
using test::byteOf;
using test::onBlack;
using test::towardsLight;

Material chalk(Shading shading = Shading::kPhysical) {
  Material material;
  material.shading = shading;
  material.baseColor = {0.6f, 0.6f, 0.6f, 1.0f};
  material.metallic = 0.0f;
  material.toon.shadeColor = {0.6f, 0.6f, 0.6f};
  return material;
}

AvatarLight keyOnly() {
  AvatarLight light = test::dark();
  light.key = Vec3f::Constant(0.9f);
  return light;
}

/// glTF's colour of chalk on the ball where its normal is n; the view is nearly along -Z.
int expectedByte(const Vec3& n, const Vec3& position) {
  const Vec3 l = towardsLight(), v = (test::frontCamera().eye - position).normalized(), h = (l + v).normalized();
  const double nl = std::max(n.dot(l), 0.0), nv = std::max(n.dot(v), 1e-4);
  return byteOf(0.9 * nl * (0.6 + (0.04 + 0.96 * std::pow(1.0 - v.dot(h), 5)) / (2.0 * (nl + nv))));
}

TEST(AvatarShadow, LitSurfacesDoNotShadowThemselves) {
  LORICA_REQUIRE_STUDIO(studio, "");
  // 5,000 triangles look up shadows at each pixel, 20,000 at each vertex.
  for (const auto& [rings, segments] : {std::pair{50, 50}, {100, 100}}) {
    for (const RenderQuality quality : kQualities) {
      studio->setQuality(quality);
      for (const bool bothSides : {false, true}) {
        AvatarMaker maker;
        Material material = chalk();
        material.doubleSided = bothSides;
        maker.material(material);
        maker.addSphere({0, 1, 0}, 0.45, rings, segments);
        const Image image =
            studio->draw(AvatarOnStage(maker.avatar).scene(), onBlack(keyOnly()), test::frontCamera(), kSide, kSide);
        int speckles = 0, tested = 0;
        for (double x = -0.4; x <= 0.4; x += 0.01) {
          for (double y = -0.4; y <= 0.4; y += 0.01) {
            if (std::hypot(x, y) > 0.4) continue;
            const Vec3 n = Vec3(x, y, std::sqrt(0.45 * 0.45 - x * x - y * y)) / 0.45;
            if (n.dot(towardsLight()) < 0.25) continue;
            const Vec3 position = Vec3(0, 1, 0) + 0.45 * n;
            const auto [column, row] = test::seenAt(position, kSide, kSide);
            const int found = test::pixelAt(image, static_cast<int>(column), static_cast<int>(row))[0];
            speckles += std::abs(found - expectedByte(n, position)) > 10;
            ++tested;
          }
        }
        ASSERT_GT(tested, 1000);
        EXPECT_EQ(speckles, 0) << rings << " rings, quality " << static_cast<int>(quality)
                               << (bothSides ? ", double-sided" : "");
      }
    }
  }
}

/// A skirt in a world that is `scale` times as large, seen by a camera that is as far away in proportion: the picture
/// is the same, but a texel of the shadow map is larger than the offset of a person's surface.
class Skirt {
 public:
  Skirt(double scale, int segments) : scale_(scale), stage_(made(scale, segments)) {}

  /// @param asParts  as an open body in colours, else as an avatar
  [[nodiscard]] Image draw(test::Studio& studio, bool asParts) const {
    const TriMesh& mesh = stage_.avatar->character.mesh;
    Scene scene;
    if (!asParts) scene = stage_.scene();
    scene.vertices = mesh.vertices;
    scene.triangles = mesh.triangles;
    Camera camera = test::frontCamera();
    camera.eye *= scale_;
    camera.target *= scale_;
    SceneOptions options = onBlack(keyOnly());
    options.colorSkinByPart = asParts;
    return studio.draw(scene, options, camera, 2 * kSide, 2 * kSide);
  }

 private:
  static Avatar made(double scale, int segments) {
    AvatarMaker maker;
    Material material = chalk();
    material.doubleSided = true;
    maker.material(material);
    maker.addSkirt(scale * Vec3(0, 1, 0), scale * 0.1, scale * 0.4, scale * 0.8, segments);
    return maker.avatar;
  }

  double scale_;
  AvatarOnStage stage_;
};

TEST(AvatarShadow, LargeOpenSurfacesHaveNoStripesAtAnyAngleToTheLight) {
  LORICA_REQUIRE_STUDIO(studio, "");
  // 128 triangles look up shadows at each pixel, 10,000 at each vertex.
  for (const int segments : {64, 5000}) {
    const Skirt small(0.5, segments), large(6.0, segments);
    for (const bool asParts : {false, true}) {
      for (const RenderQuality quality : kQualities) {
        studio->setQuality(quality);
        const Image expected = small.draw(*studio, asParts), found = large.draw(*studio, asParts);
        int striped = 0, darkest = 255, brightest = 0;
        for (double angle = 0.5; angle < 2.6; angle += 0.01) {  // away from the outline
          for (double down = 0.05; down < 0.95; down += 0.01) {
            const double radius = 0.1 + 0.3 * down;
            const Vec3 out(std::cos(angle), 0.0, std::sin(angle));
            if ((0.8 * out + 0.3 * Vec3::UnitY()).normalized().dot(towardsLight()) < 0.1) continue;
            const Vec3 position = Vec3(0.0, 1.4 - 0.8 * down, 0.0) + radius * out;
            const auto [column, row] = test::seenAt(position, 2 * kSide, 2 * kSide);
            const int now = test::pixelAt(found, static_cast<int>(column), static_cast<int>(row))[0];
            const int before = test::pixelAt(expected, static_cast<int>(column), static_cast<int>(row))[0];
            striped += std::abs(now - before) > 12;
            darkest = std::min(darkest, before);
            brightest = std::max(brightest, before);
          }
        }
        EXPECT_EQ(striped, 0) << segments << " segments, quality " << static_cast<int>(quality)
                              << (asParts ? ", parts" : "");
        EXPECT_GT(brightest, darkest + 30) << "the light falls from grazing to steep";
      }
    }
  }
}

/// A small square between the light and the middle of a large one.
AvatarMaker shaded(Shading shading, AlphaMode alpha, std::uint8_t opacity) {
  AvatarMaker maker;
  Material caster = chalk(Shading::kUnlit);
  caster.alpha = alpha;
  caster.doubleSided = true;
  caster.base = maker.picture({255, 255, 255, opacity});
  maker.material(caster);
  AvatarMaker::Quad small;
  small.center = Vec3(0, 1, 0) + 0.35 * towardsLight();
  small.half = 0.12;
  maker.add(small);
  maker.material(chalk(shading));
  maker.add({});
  return maker;
}

int middleOf(test::Studio& studio, const AvatarMaker& maker) {
  const Image image =
      studio.draw(AvatarOnStage(maker.avatar).scene(), onBlack(keyOnly()), test::frontCamera(), kSide, kSide);
  return test::pixelAt(image, kSide / 2, kSide / 2)[0];
}

TEST(AvatarShadow, FallsOnPhysicalMaterialsOnly) {
  LORICA_REQUIRE_STUDIO(studio, "");
  for (const RenderQuality quality : kQualities) {
    studio->setQuality(quality);
    EXPECT_LT(middleOf(*studio, shaded(Shading::kPhysical, AlphaMode::kOpaque, 255)), 4);
    EXPECT_NEAR(middleOf(*studio, shaded(Shading::kUnlit, AlphaMode::kOpaque, 255)), byteOf(0.6), 1);
    EXPECT_NEAR(middleOf(*studio, shaded(Shading::kToon, AlphaMode::kOpaque, 255)), byteOf(0.54), 1);
  }
}

TEST(AvatarShadow, WhatIsMostlyTransparentCastsNone) {
  LORICA_REQUIRE_STUDIO(studio, "");
  for (const AlphaMode alpha : {AlphaMode::kMask, AlphaMode::kBlend}) {
    EXPECT_LT(middleOf(*studio, shaded(Shading::kPhysical, alpha, 200)), 4);
    EXPECT_GT(middleOf(*studio, shaded(Shading::kPhysical, alpha, 60)), 100);
  }
}

TEST(AvatarShadow, FallsOnTheFloorWhereTheLightPutsIt) {
  LORICA_REQUIRE_STUDIO(studio, "");
  for (const RenderQuality quality : kQualities) {
    studio->setQuality(quality);
    AvatarMaker maker;
    maker.material(chalk());
    maker.addSphere({0, 1, 0}, 0.35, 24, 32);
    const AvatarOnStage stage(maker.avatar);
    SceneOptions options = onBlack();
    options.ground = true;
    options.background.reset();
    Camera camera;
    camera.eye = {0, 4, 5};
    camera.target = {0, 0.5, 0};
    const Image lit = studio->draw({}, options, camera, kSide, kSide);
    const Image image = studio->draw(stage.scene(), options, camera, kSide, kSide);
    const FrameSetup setup = setUpFrame(stage.scene(), options, camera, kSide, kSide, 256);
    const Vec3 fallen = Vec3(0, 1, 0) - towardsLight() / towardsLight().y();
    const Eigen::Vector4f c = setup.uniforms.clipFromWorld *
                              Eigen::Vector4f(static_cast<float>(fallen.x()), 0, static_cast<float>(fallen.z()), 1);
    const int x = static_cast<int>(0.5f * kSide * (1 + c.x() / c.w()));
    const int y = static_cast<int>(0.5f * kSide * (1 - c.y() / c.w()));
    EXPECT_LT(test::pixelAt(image, x, y)[0], test::pixelAt(lit, x, y)[0] - 25);
    EXPECT_NEAR(test::pixelAt(image, 2, kSide - 3)[0], test::pixelAt(lit, 2, kSide - 3)[0], 3);
  }
}

TEST(AvatarShadow, FeetDarkenTheFloorTheyStandOn) {
  LORICA_REQUIRE_STUDIO(studio, "");
  Camera camera;
  camera.eye = {0, 20, 0.5};
  camera.target = {0, 0, 0};
  camera.verticalFov = 0.08;
  const auto brightness = [&](double height) {
    AvatarMaker maker;
    maker.material(chalk());
    maker.addSphere({0, 0.2 + height, 0}, 0.2, 24, 32);
    SceneOptions options = onBlack();
    options.ground = true;
    // On the side of the light, where no shadow falls.
    const AvatarOnStage stage(maker.avatar);
    const FrameSetup setup = setUpFrame(stage.scene(), options, camera, kSide, kSide, 256);
    const Eigen::Vector4f c = setup.uniforms.clipFromWorld * Eigen::Vector4f(-0.21f, 0, 0.05f, 1);
    const Image image = studio->draw(stage.scene(), options, camera, kSide, kSide);
    return test::pixelAt(image, static_cast<int>(0.5f * kSide * (1 + c.x() / c.w())),
                         static_cast<int>(0.5f * kSide * (1 - c.y() / c.w())))[1];
  };
  EXPECT_LT(brightness(0.0), brightness(0.6) - 5);
}

// Avatars' transparency by closed forms: masks, blending, the order of layers, sides.

TEST(AvatarAlpha, MaskCutsAtTheCutoffAndOpaqueIgnoresAlpha) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const auto look = [&](AlphaMode mode, std::uint8_t alpha, float cutoff) {
    AvatarMaker maker;
    Material material = unlit();
    material.alpha = mode;
    material.alphaCutoff = cutoff;
    material.base = maker.picture({255, 255, 255, alpha});
    maker.material(material);
    maker.add({});
    return seen(drawn(*studio, maker, onBlack()))[0];
  };
  EXPECT_EQ(look(AlphaMode::kMask, 127, 0.5f), 0);
  EXPECT_EQ(look(AlphaMode::kMask, 128, 0.5f), 255);
  EXPECT_EQ(look(AlphaMode::kMask, 76, 0.3f), 0);
  EXPECT_EQ(look(AlphaMode::kMask, 77, 0.3f), 255);
  EXPECT_EQ(look(AlphaMode::kOpaque, 0, 0.5f), 255);
  EXPECT_NEAR(look(AlphaMode::kBlend, 51, 0.5f), 51, 1) << "blended in sRGB, as web pages do";
}

/// A far and a near square that overlap in the middle.
AvatarMaker layers(const Material& far, const Material& near, bool farFirst) {
  AvatarMaker maker;
  for (const bool isFar : {farFirst, !farFirst}) {
    maker.material(isFar ? far : near);
    AvatarMaker::Quad quad;
    quad.center.z() = isFar ? -0.3 : 0.0;
    maker.add(quad);
  }
  return maker;
}

Material glass(const Vec3f& color, float alpha) {
  Material material = unlit();
  material.alpha = AlphaMode::kBlend;
  material.baseColor << color, alpha;
  return material;
}

TEST(AvatarAlpha, BlendedLayersAreSortedWhateverTheirOrder) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const Material red = glass({1, 0, 0}, 0.4f), blue = glass({0, 0, 1}, 0.4f);
  const Image first = drawn(*studio, layers(red, blue, true), onBlack());
  EXPECT_EQ(drawn(*studio, layers(red, blue, false), onBlack()).rgba, first.rgba);
  expectNear(seen(first), {static_cast<int>(0.6 * 0.4 * 255), 0, 102}, 2);
}

TEST(AvatarAlpha, HairThatIsMostlyOpaqueHidesHairBehindItInOneMesh) {
  LORICA_REQUIRE_STUDIO(studio, "");
  Image pictures[2];
  for (const bool farFirst : {false, true}) {
    AvatarMaker maker = layers(glass({1, 1, 1}, 0.8f), glass({1, 1, 1}, 0.8f), farFirst);
    Look& look = maker.avatar.look;
    look.groups = {{"hair", 0, 0, 4, false}};
    pictures[farFirst] = drawn(*studio, maker, onBlack());
  }
  EXPECT_EQ(pictures[0].rgba, pictures[1].rgba);
  expectNear(seen(pictures[0]), {204, 204, 204}, 1);
}

TEST(AvatarAlpha, TheMakersOrderComesBeforeTheDistance) {
  LORICA_REQUIRE_STUDIO(studio, "");
  Material red = glass({1, 0, 0}, 0.4f), blue = glass({0, 0, 1}, 0.4f);
  red.drawOrder = 1;  // after blue, though it is behind
  expectNear(seen(drawn(*studio, layers(red, blue, true), onBlack())), {102, 0, static_cast<int>(0.6 * 0.4 * 255)}, 2);
  blue.blendWritesDepth = true;  // then blue hides what is drawn later behind it
  expectNear(seen(drawn(*studio, layers(red, blue, true), onBlack())), {0, 0, 102}, 2);
}

TEST(AvatarAlpha, OpaqueSurfacesHideBlendedOnesBehindThem) {
  LORICA_REQUIRE_STUDIO(studio, "");
  Material green = unlit();
  green.baseColor = {0, 1, 0, 1};
  const Material red = glass({1, 0, 0}, 0.5f);
  expectNear(seen(drawn(*studio, layers(red, green, true), onBlack())), {0, 255, 0}, 0);
  expectNear(seen(drawn(*studio, layers(green, red, true), onBlack())), {128, 128, 0}, 1);
}

TEST(AvatarAlpha, OnlyDoubleSidedMaterialsAreSeenFromBehind) {
  LORICA_REQUIRE_STUDIO(studio, "");
  for (const AlphaMode mode : {AlphaMode::kOpaque, AlphaMode::kMask, AlphaMode::kBlend}) {
    for (const bool both : {false, true}) {
      AvatarMaker maker;
      Material material = unlit();
      material.alpha = mode;
      material.doubleSided = both;
      maker.material(material);
      AvatarMaker::Quad quad;
      quad.facesAway = true;
      maker.add(quad);
      EXPECT_EQ(seen(drawn(*studio, maker, onBlack()))[0], both ? 255 : 0);
    }
  }
}

}  // namespace
}  // namespace lorica
