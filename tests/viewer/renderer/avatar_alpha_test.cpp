// Avatars' transparency by closed forms: masks, blending, the order of layers, sides.

#include "tests/viewer/renderer/avatar_squares.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

using test::AvatarMaker;
using test::drawn;
using test::expectNear;
using test::onBlack;
using test::seen;
using test::unlit;

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
