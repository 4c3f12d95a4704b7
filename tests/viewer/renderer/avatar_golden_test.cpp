// Golden pictures of avatars' materials. Each is also drawn without its feature, which the comparison must detect.

#include "tests/viewer/renderer/avatars.h"
#include "tests/viewer/renderer/picture_error.h"
#include "tests/viewer/renderer/pictures.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

namespace lorica {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
using test::AvatarMaker;
using test::AvatarOnStage;

/// A checker of 8 x 8 fields in two colours.
TextureUse checker(AvatarMaker& maker, std::array<std::uint8_t, 4> a, std::array<std::uint8_t, 4> b) {
  std::vector<std::array<std::uint8_t, 4>> texels;
  for (int i = 0; i < 64; ++i) texels.push_back((i + i / 8) % 2 == 0 ? a : b);
  return maker.picture(8, 8, texels);
}

/// A strip of hair: opaque, with edges that fade.
TextureUse strands(AvatarMaker& maker, std::array<std::uint8_t, 3> color) {
  std::vector<std::array<std::uint8_t, 4>> texels;
  for (int i = 0; i < 32; ++i) {
    const int fade = std::min({i % 8, 7 - i % 8, 2});
    texels.push_back({color[0], color[1], color[2], static_cast<std::uint8_t>(fade * 127)});
  }
  TextureUse use = maker.picture(32, 1, texels);
  use.smooth = true;
  return use;
}

/// Spheres in a row and two rows, each with its own material.
void spheres(AvatarMaker& maker, int count, const std::function<Material(int)>& materialOf) {
  for (int i = 0; i < count; ++i) {
    maker.material(materialOf(i));
    const int columns = count > 4 ? count / 2 : count;
    maker.addSphere({0.5 * (i % columns) - 0.25 * (columns - 1), i < columns && count > 4 ? 1.3 : 0.75, 0.0}, 0.22, 32,
                    48);
  }
}

AvatarMaker alphaModes(bool feature) {
  AvatarMaker maker;
  for (const AlphaMode mode : {AlphaMode::kOpaque, AlphaMode::kMask, AlphaMode::kBlend}) {
    for (const double behind : {0.0, 0.25}) {
      Material material;
      material.shading = Shading::kUnlit;
      material.alpha = feature ? mode : AlphaMode::kOpaque;
      material.doubleSided = true;
      material.base = strands(
          maker, behind > 0.0 ? std::array<std::uint8_t, 3>{200, 60, 30} : std::array<std::uint8_t, 3>{40, 90, 190});
      maker.material(material);
      AvatarMaker::Quad quad;
      quad.center = {0.6 * (static_cast<int>(mode) - 1) + 0.3 * behind, 1.0 + 0.4 * behind, -behind};
      quad.half = 0.25;
      maker.add(quad);
    }
  }
  return maker;
}

AvatarMaker physical(bool feature) {
  AvatarMaker maker;
  spheres(maker, 8, [&](int i) {
    Material material;
    material.baseColor = {0.85f, 0.55f, 0.25f, 1.0f};
    material.metallic = feature && i < 4 ? 1.0f : 0.0f;
    material.roughness = feature ? 0.05f + 0.3f * static_cast<float>(i % 4) : 1.0f;
    return material;
  });
  return maker;
}

AvatarMaker toon(bool feature) {
  AvatarMaker maker;
  spheres(maker, 8, [&](int i) {
    Material material;
    material.shading = Shading::kToon;
    material.baseColor = {0.9f, 0.7f, 0.6f, 1.0f};
    material.toon.shadeColor = {0.45f, 0.2f, 0.3f};
    material.toon.toony = feature && i == 1 ? 0.2f : 0.95f;
    material.toon.shift = feature && i == 2 ? 0.4f : -0.1f;
    if (feature && i == 3) material.toon.rimColor = {0.2f, 0.8f, 1.0f};
    if (feature && i == 4) {
      material.toon.rimLightingMix = 0.0f;
      material.toon.matcap =
          maker.picture(2, 2, {{90, 0, 0, 255}, {0, 90, 0, 255}, {0, 0, 90, 255}, {90, 90, 90, 255}});
    }
    if (feature && i >= 5) {
      material.toon.outline = i == 5 ? OutlineMode::kWorld : OutlineMode::kScreen;
      material.toon.outlineWidth = i == 7 ? 0.05f : 0.02f;
      material.toon.outlineColor = {0.1f, 0.0f, 0.4f};
      material.toon.outlineLightingMix = i == 5 ? 0.0f : 1.0f;
    }
    return material;
  });
  return maker;
}

/// A normal map of four pyramids, lit from the upper left: their upper and left sides are bright.
AvatarMaker normalMap(bool feature) {
  AvatarMaker maker;
  Material material;
  material.baseColor = {0.6f, 0.6f, 0.6f, 1.0f};
  material.metallic = 0.0f;
  std::vector<std::array<std::uint8_t, 4>> texels;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const int u = x % 16 - 8, v = y % 16 - 8;
      const bool across = std::abs(2 * u + 1) > std::abs(2 * v + 1);
      const int right = across ? (u < 0 ? -1 : 1) : 0, up = across ? 0 : (v < 0 ? 1 : -1);
      texels.push_back(
          {static_cast<std::uint8_t>(128 + 76 * right), static_cast<std::uint8_t>(128 + 76 * up), 230, 255});
    }
  }
  const TextureUse bumps = maker.picture(32, 32, texels);
  for (const int side : {-1, 1}) {
    if (feature) material.normal = bumps;
    maker.material(material);
    AvatarMaker::Quad quad;
    quad.center = {0.45 * side, 1.0, 0.0};
    quad.half = 0.4;
    if (side > 0) {  // mirrored, which must look the same
      std::swap(quad.uLeft, quad.uRight);
      quad.tangent = {-1.0f, 0.0f, 0.0f, -1.0f};
    }
    maker.add(quad);
  }
  return maker;
}

AvatarMaker textures(bool feature) {
  AvatarMaker maker;
  constexpr std::array kWraps = {TextureWrap::kRepeat, TextureWrap::kMirror, TextureWrap::kClamp};
  for (int i = 0; i < 6; ++i) {
    Material material;
    material.shading = Shading::kUnlit;
    material.base = checker(maker, {230, 200, 60, 255}, {30, 60, 120, 255});
    if (feature) {
      material.base.wrapU = material.base.wrapV = kWraps[i % 3];
      material.base.smooth = i >= 3;
      material.base.transform << 1.5f, 0.3f, -0.4f, -0.3f, 1.5f, -0.1f;
    }
    maker.material(material);
    AvatarMaker::Quad quad;
    quad.center = {0.6 * (i % 3) - 0.6, i < 3 ? 1.3 : 0.7, 0.0};
    quad.half = 0.27;
    quad.color = feature ? Eigen::Vector4f(1.0f, 1.0f - 0.1f * static_cast<float>(i), 1.0f, 1.0f)
                         : Eigen::Vector4f(1.0f, 1.0f, 1.0f, 1.0f);
    maker.add(quad);
  }
  return maker;
}

/// Two balls before a wall that is seen from behind: the upper one's shadow falls on the lower one.
AvatarMaker shadows(bool feature) {
  AvatarMaker maker;
  Material material;
  material.baseColor = {0.7f, 0.6f, 0.5f, 1.0f};
  material.metallic = 0.0f;
  material.shading = feature ? Shading::kPhysical : Shading::kUnlit;
  material.doubleSided = feature;
  maker.material(material);
  maker.addSphere({0.3, 0.4, 0.0}, 0.35, 32, 48);
  maker.addSphere({0.0, 1.1, 0.15}, 0.25, 32, 48);
  AvatarMaker::Quad back;
  back.center = {0.1, 0.6, -0.4};
  back.half = 0.6;
  back.facesAway = true;
  maker.add(back);
  return maker;
}

struct Feature {
  const char* name;
  AvatarMaker (*make)(bool);
};

class GoldenAvatar : public ::testing::TestWithParam<Feature> {};

Image drawn(test::Studio& studio, const Feature& feature, bool with, RenderQuality quality) {
  SceneOptions options;
  options.colorSkinByPart = options.hulls = false;
  studio.setQuality(quality);
  Camera camera = test::frontCamera();
  camera.eye.y() = 1.3;
  return studio.draw(AvatarOnStage(feature.make(with).avatar).scene(), options, camera, kWidth, kHeight);
}

TEST_P(GoldenAvatar, IsAsItWas) {
  const Feature& feature = GetParam();
  LORICA_REQUIRE_STUDIO(studio, "");
  const std::string name = std::string("avatar_") + feature.name;
  test::expectGolden(name, drawn(*studio, feature, true, RenderQuality::kHigh));
  const Image without = drawn(*studio, feature, false, RenderQuality::kHigh);
  EXPECT_GT(test::pictureError(without, test::readGolden(name)).wrong, 4.0 * test::kMaxWrong);
}

TEST_P(GoldenAvatar, LooksAlikeInAllQualities) {
  const Feature& feature = GetParam();
  LORICA_REQUIRE_STUDIO(studio, "");
  const Image high = drawn(*studio, feature, true, RenderQuality::kHigh);
  for (const RenderQuality quality : {RenderQuality::kMedium, RenderQuality::kLow}) {
    const Image image = drawn(*studio, feature, true, quality);
    EXPECT_LT(test::pictureError(image, high).wrong, 0.05) << static_cast<int>(quality);
  }
}

INSTANTIATE_TEST_SUITE_P(Each, GoldenAvatar,
                         ::testing::Values(Feature{"alpha", alphaModes}, Feature{"physical", physical},
                                           Feature{"toon", toon}, Feature{"normal_map", normalMap},
                                           Feature{"textures", textures}, Feature{"shadows", shadows}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace lorica
