// Avatars' materials by closed forms: colours, light, textures. Each test draws a square of 73 x 73 pixels.

#include "tests/viewer/renderer/avatar_squares.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica {
namespace {

using test::AvatarMaker;
using test::byteOf;
using test::dark;
using test::drawn;
using test::expectNear;
using test::kSquareHeight;
using test::kSquareWidth;
using test::onBlack;
using test::Pixel;
using test::seen;
using test::towardsLight;
using test::unlit;

Pixel bytesOf(const Vec3& linear) {
  return {byteOf(linear.x()), byteOf(linear.y()), byteOf(linear.z())};
}

/// Rough and not metallic.
Material chalk(float base) {
  Material material;
  material.baseColor = {base, base, base, 1.0f};
  material.metallic = 0.0f;
  return material;
}

/// What glTF's formulas give for chalk in the key light alone, at the centre of the picture: there D = 1 and
/// V = 1 / (2 (n.l + n.v)).
double chalkInKeyLight(double base, const Vec3& n, double key = 1.0) {
  const Vec3 l = towardsLight(), v = Vec3::UnitZ(), h = (l + v).normalized();
  const double nl = std::max(n.dot(l), 0.0), nv = std::max(n.dot(v), 1e-4);
  const double fresnel = 0.04 + 0.96 * std::pow(1.0 - v.dot(h), 5);
  return key * nl * (base + fresnel / (2.0 * (nl + nv)));
}

AvatarLight keyOnly(float key) {
  AvatarLight light = dark();
  light.key = Vec3f::Constant(key);
  return light;
}

TEST(AvatarSurface, UnlitTexturesComeOutAsTheyAreInAllGreyLevels) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarMaker maker;
  std::vector<std::array<std::uint8_t, 4>> texels;
  for (int i = 0; i < 256; ++i) {
    const auto grey = static_cast<std::uint8_t>(i);
    texels.push_back({grey, grey, static_cast<std::uint8_t>(255 - i), 255});
  }
  Material material = unlit();
  material.base = maker.picture(16, 16, texels);
  maker.material(material);
  maker.add({});
  const Image image = drawn(*studio, maker, onBlack());
  for (int i = 0; i < 256; ++i) {
    const double x = (i % 16 + 0.5) / 16.0 - 0.5, y = 0.5 - (i / 16 + 0.5) / 16.0;
    expectNear(seen(image, x, y), {i, i, 255 - i}, 1, std::to_string(i));
  }
}

TEST(AvatarSurface, FactorsAreLinear) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarMaker maker;
  Material material = unlit();
  material.baseColor = {0.5f, 0.25f, 0.01f, 1.0f};
  material.base = maker.picture({188, 255, 255, 255});
  maker.material(material);
  AvatarMaker::Quad quad;
  quad.color = {1.0f, 0.5f, 0.1f, 1.0f};
  maker.add(quad);
  const double red = 0.5 * test::linearOf(188);
  expectNear(seen(drawn(*studio, maker, onBlack())), bytesOf({red, 0.125, 0.001}), 1);
}

TEST(AvatarSurface, TheKeyLightFollowsLambertAndFresnel) {
  LORICA_REQUIRE_STUDIO(studio, "");
  for (const Vec3& normal :
       {Vec3(0, 0, 1), Vec3(-0.6, 0, 0.8), Vec3(0.6, 0, 0.8), Vec3(0, 0.8, 0.6), Vec3(0, -0.8, 0.6)}) {
    AvatarMaker maker;
    maker.material(chalk(0.5f));
    AvatarMaker::Quad quad;
    quad.normal = normal.cast<float>();
    maker.add(quad);
    const Pixel found = seen(drawn(*studio, maker, onBlack(keyOnly(0.9f))));
    const int expected = byteOf(chalkInKeyLight(0.5, normal, 0.9));
    expectNear(found, {expected, expected, expected}, 2, "normal " + std::to_string(normal.x()));
  }
}

TEST(AvatarSurface, AWhiteSurfaceInAnEvenSkyIsAsBrightAsTheSky) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarLight even = dark();
  even.sky = even.ground = Vec3f(0.5f, 0.4f, 0.3f);
  for (const float metallic : {0.0f, 1.0f}) {
    for (const float roughness : {0.0f, 0.3f, 0.6f, 1.0f}) {
      AvatarMaker maker;
      Material material = chalk(1.0f);
      material.metallic = metallic;
      material.roughness = roughness;
      maker.material(material);
      maker.addSphere({0, 1, 0}, 0.5, 24, 32);
      const Image image = drawn(*studio, maker, onBlack(even));
      for (const double x : {-0.4, 0.0, 0.4}) {
        expectNear(seen(image, x, 0.1), bytesOf({0.5, 0.4, 0.3}), 2,
                   "metallic " + std::to_string(metallic) + ", roughness " + std::to_string(roughness));
      }
    }
  }
}

TEST(AvatarSurface, AMirrorShowsTheSkyAboveAndTheGroundBelow) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarLight light = dark();
  light.sky = Vec3f(0.0f, 0.0f, 0.8f);
  light.ground = Vec3f(0.6f, 0.0f, 0.0f);
  AvatarMaker maker;
  Material mirror;
  mirror.roughness = 0.0f;
  maker.material(mirror);
  maker.addSphere({0, 1, 0}, 0.5, 64, 96);
  const Image image = drawn(*studio, maker, onBlack(light));
  expectNear(seen(image, 0.0, 0.35), bytesOf({0.0, 0.0, 0.8}), 16);
  expectNear(seen(image, 0.0, -0.35), bytesOf({0.6, 0.0, 0.0}), 16);
}

TEST(AvatarSurface, OcclusionDarkensOnlyTheAmbientLight) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const auto look = [&](std::optional<std::uint8_t> open, float strength, const AvatarLight& light) {
    AvatarMaker maker;
    Material material = chalk(0.5f);
    if (open) material.occlusion = maker.picture({*open, 0, 0, 255});
    material.occlusionStrength = strength;
    maker.material(material);
    maker.add({});
    return seen(drawn(*studio, maker, onBlack(light)))[0];
  };
  AvatarLight ambient = dark();
  ambient.sky = ambient.ground = Vec3f::Constant(0.8f);
  EXPECT_NEAR(look({}, 1.0f, ambient), byteOf(test::linearOf(look(255, 1.0f, ambient))), 1);
  EXPECT_EQ(look(0, 1.0f, ambient), 0);
  const double half = 1.0 + 0.6 * (51 / 255.0 - 1.0);
  EXPECT_NEAR(look(51, 0.6f, ambient), byteOf(half * test::linearOf(look(255, 1.0f, ambient))), 2);
  EXPECT_EQ(look(0, 1.0f, keyOnly(0.9f)), look({}, 1.0f, keyOnly(0.9f)));
}

TEST(AvatarSurface, RoughnessIsGreenAndMetalIsBlue) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const auto look = [&](bool texture) {
    AvatarMaker maker;
    Material material = chalk(0.7f);
    material.metallic = texture ? 0.8f : 0.4f;
    material.roughness = texture ? 0.9f : 0.45f;
    if (texture) material.metallicRoughness = maker.picture({13, 128, 128, 255});
    maker.material(material);
    maker.addSphere({0, 1, 0}, 0.5, 24, 32);
    return drawn(*studio, maker, onBlack());
  };
  EXPECT_EQ(test::differingPixels(look(true), look(false), 4), 0);
}

TEST(AvatarSurface, EmissionIsAddedAndClamped) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarMaker maker;
  Material material = chalk(0.0f);
  material.emissive = {0.25f, 4.0f, 0.5f};
  material.emissiveTexture = maker.picture({255, 255, 188, 255});
  maker.material(material);
  maker.add({});
  expectNear(seen(drawn(*studio, maker, onBlack(dark()))), {byteOf(0.25), 255, byteOf(0.5 * test::linearOf(188))}, 1);
}

/// A normal map's texel that leans to the right or up by an angle whose sine is 0.6.
struct Bump {
  const char* name;
  double right, up;
};

TEST(AvatarSurface, NormalMapsPointRightForRedAndUpForGreen) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const auto texel = [](double c) { return static_cast<std::uint8_t>(std::lround(127.5 + 127.5 * c)); };
  for (const Bump& bump : {Bump{"left", -0.6, 0}, {"right", 0.6, 0}, {"up", 0, 0.6}, {"down", 0, -0.6}}) {
    for (const bool tangents : {false, true}) {
      for (const bool mirrored : {false, true}) {  // the texture, so that its right is the picture's left
        for (const bool back : {false, true}) {
          AvatarMaker maker;
          Material material = chalk(0.5f);
          material.doubleSided = back;
          material.normal = maker.picture({texel(bump.right), texel(bump.up), texel(0.8), 255});
          maker.material(material);
          AvatarMaker::Quad quad;
          quad.facesAway = back;
          if (mirrored) std::swap(quad.uLeft, quad.uRight);
          const float alongU = (mirrored ? -1.0f : 1.0f) * (back ? -1.0f : 1.0f);
          if (tangents) quad.tangent = {alongU, 0.0f, 0.0f, mirrored ? -1.0f : 1.0f};
          maker.add(quad);
          // Of the front. The back's is the opposite, as glTF asks.
          Vec3 normal = alongU * bump.right * Vec3::UnitX() + bump.up * Vec3::UnitY() + 0.8 * Vec3::UnitZ();
          if (back) normal = {-normal.x(), -normal.y(), normal.z()};
          const int expected = byteOf(chalkInKeyLight(0.5, normal, 0.9));
          const Pixel found = seen(drawn(*studio, maker, onBlack(keyOnly(0.9f))), 0.1, 0.1);
          expectNear(found, {expected, expected, expected}, 4,
                     std::string(bump.name) + (tangents ? ", tangents" : "") + (mirrored ? ", mirrored" : "") +
                         (back ? ", from behind" : ""));
        }
      }
    }
  }
}

TEST(AvatarSurface, TheNormalScaleFlattens) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarMaker maker;
  Material material = chalk(0.5f);
  material.normal = maker.picture({204, 128, 230, 255});  // 0.6, 0, 0.8
  material.normalScale = 0.5f;
  maker.material(material);
  maker.add({});
  const int expected = byteOf(chalkInKeyLight(0.5, Vec3(0.3, 0.0, 0.8).normalized(), 0.9));
  expectNear(seen(drawn(*studio, maker, onBlack(keyOnly(0.9f)))), {expected, expected, expected}, 3);
}

TEST(AvatarSurface, WithoutNormalsTrianglesAreFlat) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarMaker maker;
  maker.material(chalk(0.5f));
  AvatarMaker::Quad quad;
  quad.normal = Vec3f::Zero();
  maker.add(quad);
  const int expected = byteOf(chalkInKeyLight(0.5, Vec3::UnitZ(), 0.9));
  expectNear(seen(drawn(*studio, maker, onBlack(keyOnly(0.9f)))), {expected, expected, expected}, 3);
}

TEST(AvatarSurface, TrianglesWithoutAreaChangeNothing) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarMaker maker;
  maker.material(chalk(0.5f));
  maker.add({});
  const Image plain = drawn(*studio, maker, onBlack());
  AvatarMaker::Quad point;
  point.half = 0.0;
  point.normal = Vec3f::Zero();
  maker.add(point);
  EXPECT_EQ(drawn(*studio, maker, onBlack()).rgba, plain.rgba);
}

// A texture of 2 x 2: red, green above blue, white.
const std::vector<std::array<std::uint8_t, 4>> kFour = {
    {255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 255, 255}};
constexpr Pixel kRed = {255, 0, 0}, kGreen = {0, 255, 0}, kBlue = {0, 0, 255}, kWhite = {255, 255, 255};

TEST(AvatarTextures, AreUprightAndTransformed) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const auto corners = [&](const Eigen::Matrix<float, 2, 3>& transform, int uvSet) {
    AvatarMaker maker;
    Material material = unlit();
    material.base = maker.picture(2, 2, kFour);
    material.base.transform = transform;
    material.base.uvSet = uvSet;
    maker.material(material);
    maker.add({});
    maker.avatar.look.uv[1] = maker.avatar.look.uv[0];
    for (Eigen::Vector2f& uv : maker.avatar.look.uv[1]) uv = Eigen::Vector2f(1.0f - uv.x(), uv.y());
    const Image image = drawn(*studio, maker, onBlack());
    return std::array{seen(image, -0.25, 0.25), seen(image, 0.25, 0.25), seen(image, -0.25, -0.25),
                      seen(image, 0.25, -0.25)};
  };
  Eigen::Matrix<float, 2, 3> transform = Eigen::Matrix<float, 2, 3>::Identity();
  EXPECT_EQ(corners(transform, 0), (std::array{kRed, kGreen, kBlue, kWhite}));
  EXPECT_EQ(corners(transform, 1), (std::array{kGreen, kRed, kWhite, kBlue})) << "the second set";
  transform << 0, 1, 0, -1, 0, 1;  // a quarter turn about the middle
  EXPECT_EQ(corners(transform, 0), (std::array{kBlue, kRed, kWhite, kGreen}));
  transform << 0.5f, 0, 0.5f, 0, 0.5f, 0;  // the upper right quarter
  EXPECT_EQ(corners(transform, 0), (std::array{kGreen, kGreen, kGreen, kGreen}));
}

TEST(AvatarTextures, WrapAsTheySay) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const auto row = [&](TextureWrap wrap) {
    AvatarMaker maker;
    Material material = unlit();
    material.base = maker.picture(2, 2, kFour);
    material.base.wrapU = wrap;
    maker.material(material);
    AvatarMaker::Quad quad;
    quad.uLeft = -1.0f;
    quad.uRight = 2.0f;
    maker.add(quad);
    const Image image = drawn(*studio, maker, onBlack());
    std::string word;
    for (int i = 0; i < 6; ++i) word += seen(image, (i + 0.5) / 6.0 - 0.5, 0.25) == kRed ? 'r' : 'g';
    return word;
  };
  EXPECT_EQ(row(TextureWrap::kRepeat), "rgrgrg");
  EXPECT_EQ(row(TextureWrap::kMirror), "grrggr");
  EXPECT_EQ(row(TextureWrap::kClamp), "rrrggg");
}

TEST(AvatarTextures, LinearFilteringMixesInLinearLight) {
  LORICA_REQUIRE_STUDIO(studio, "");
  for (const bool smooth : {false, true}) {
    AvatarMaker maker;
    Material material = unlit();
    material.base = maker.picture(2, 1, {{0, 0, 0, 255}, {255, 255, 255, 255}});
    material.base.smooth = smooth;
    maker.material(material);
    maker.add({});
    const Image image = drawn(*studio, maker, onBlack());
    const auto [column, row] = test::seenAt({0.1, 1.0, 0.0}, kSquareWidth, kSquareHeight);
    const double u = ((std::floor(column) + 0.5) - 0.5 * kSquareWidth) /
                     (test::seenAt({0.5, 1, 0}, kSquareWidth, kSquareHeight)[0] - 0.5 * kSquareWidth) * 0.5;
    const int expected = smooth ? byteOf(0.5 + 2.0 * u) : 255;
    expectNear(seen(image, 0.1, 0.0), {expected, expected, expected}, 3, smooth ? "smooth" : "nearest");
  }
}

TEST(AvatarTextures, ThatAreMissingLeaveTheMaterialPlain) {
  LORICA_REQUIRE_STUDIO(studio, "");
  for (const Shading shading : {Shading::kPhysical, Shading::kUnlit, Shading::kToon}) {
    const auto look = [&](bool missing) {
      AvatarMaker maker;
      Material material = chalk(0.5f);
      material.shading = shading;
      material.emissive = {0.02f, 0.0f, 0.0f};
      material.toon.shadeColor = {0.2f, 0.1f, 0.1f};
      material.toon.outline = OutlineMode::kWorld;
      material.toon.outlineWidth = 0.05f;
      const TextureUse none = maker.picture(0, 0, {});
      for (TextureUse* use :
           {&material.base, &material.metallicRoughness, &material.normal, &material.occlusion,
            &material.emissiveTexture, &material.toon.shade, &material.toon.shiftTexture, &material.toon.matcap,
            &material.toon.rim, &material.toon.outlineWidthTexture, &material.toon.uvAnimationMask}) {
        if (missing) *use = none;
      }
      maker.material(material);
      maker.addSphere({0, 1, 0}, 0.4, 16, 24);
      return drawn(*studio, maker, onBlack());
    };
    EXPECT_EQ(look(true).rgba, look(false).rgba) << static_cast<int>(shading);
  }
}

}  // namespace
}  // namespace lorica
