#include "geometry/convex_hull.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/meshes.h"
#include "tests/viewer/renderer/avatars.h"
#include "tests/viewer/renderer/picture_error.h"
#include "tests/viewer/renderer/pictures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace lorica {
namespace {

// Golden pictures of avatars' materials. Each is also drawn without its feature, which the comparison must detect.

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

/// The joint with the largest weight of a vertex.
JointIndex leader(const Character& character, VertexIndex v) {
  const auto i = static_cast<std::size_t>(v);
  Influence best;
  for (std::uint32_t k = character.influenceBegin[i]; k < character.influenceBegin[i + 1]; ++k) {
    if (character.influences[k].weight > best.weight) best = character.influences[k];
  }
  return best.joint;
}

/// The mannequin in its bind pose, with one part for each bone except the fingers, and props around it.
struct Golden : ::testing::Test {
  static const Character& mannequin() {
    static const Character character = makeMannequin();
    return character;
  }

  std::vector<PartIndex> partOfTriangle;
  std::vector<LivePart> parts;
  std::vector<Affine3> worldFromJoint;
  std::vector<Prop> props;
  std::vector<Contact> contacts;
  std::vector<Vec3f> particles;
  Image inset;
  Scene scene;
  SceneOptions nothing;
  Camera camera;

  Golden() {
    const Character& character = mannequin();
    std::vector<std::vector<Vec3>> pointsOfJoint(static_cast<std::size_t>(character.skeleton.jointCount()));
    std::vector<PartIndex> partOfVertex;
    partOfVertex.reserve(character.mesh.vertices.size());
    for (std::size_t v = 0; v < character.mesh.vertices.size(); ++v) {
      JointIndex joint = leader(character, static_cast<VertexIndex>(v));
      while (isFinger(character.skeleton.joint(joint).name)) joint = character.skeleton.joint(joint).parent;
      partOfVertex.push_back(static_cast<PartIndex>(joint));
      pointsOfJoint[joint].push_back(character.mesh.vertices[v]);
    }
    partOfTriangle.reserve(character.mesh.triangles.size());
    for (const Triangle& t : character.mesh.triangles) {
      partOfTriangle.push_back(partOfVertex[t[0]]);
    }
    parts.resize(pointsOfJoint.size());
    for (std::size_t j = 0; j < parts.size(); ++j) parts[j].shape = convexHull(pointsOfJoint[j]);
    worldFromJoint.reserve(character.jointFromModel.size());
    for (const Affine3& jointFromModel : character.jointFromModel) worldFromJoint.push_back(jointFromModel.inverse());

    for (int i = 0; i < 5; ++i) {
      Prop prop;
      prop.shape = static_cast<PropShape>(i);
      prop.halfExtents = Vec3(0.13, 0.2, i == 0 ? 0.1 : 0.13);
      prop.worldFromProp.translation() = Vec3(-0.9 + 0.45 * i, 0.22 + 0.06 * i, 0.6);
      prop.worldFromProp.rotate(Eigen::AngleAxisd(0.4 + 0.2 * i, Vec3(1.0, 0.5 * i, 0.7).normalized()));
      prop.color = Vec3f(0.15f + 0.15f * static_cast<float>(i), 0.35f, 0.75f - 0.15f * static_cast<float>(i));
      if (prop.shape == PropShape::kMesh) {
        auto mesh = std::make_shared<PropMeshShape>();
        mesh->shown = test::makeTorus(0.16, 0.06, 24, 12);
        mesh->hulls = {convexHull(mesh->shown.vertices)};
        prop.mesh = mesh;
      }
      props.push_back(prop);
    }
    for (int i = 0; i < 16; ++i) {
      Contact contact;
      contact.point = Vec3(-0.75 + 0.1 * i, 1.2 + 0.3 * std::sin(1.1 * i), i % 3 == 0 ? -0.3 : 0.35);
      contacts.push_back(contact);
    }
    // A cone of balls in layers.
    for (int layer = 0; layer < 16; ++layer) {
      for (int i = -16; i <= 16; ++i) {
        for (int k = -16; k <= 16; ++k) {
          const double half = 0.5 * (layer % 2);
          if (std::hypot(i + half, k + half) > 15.5 - layer) continue;
          particles.push_back(
              (Vec3(0.55 + 0.025 * (i + half), 0.0125 + 0.018 * layer, 0.1 + 0.025 * (k + half))).cast<float>());
        }
      }
    }
    inset = {80, 60, {}};
    for (int y = 0; y < 60; ++y) {
      for (int x = 0; x < 80; ++x) {
        const bool ring = std::abs(std::hypot(x - 40, y - 25) - 15) < 4;
        for (const int c : {ring ? 250 : 20, 3 * x, 4 * y, 255}) inset.rgba.push_back(static_cast<std::uint8_t>(c));
      }
    }

    scene.vertices = character.mesh.vertices;
    scene.triangles = character.mesh.triangles;
    scene.partOfTriangle = partOfTriangle;
    scene.parts = parts;
    scene.props = props;
    scene.contacts = contacts;
    scene.particles = particles;
    scene.particleRadius = 0.0125f;
    scene.skeleton = &character.skeleton;
    scene.worldFromJoint = worldFromJoint;
    nothing.skin = nothing.colorSkinByPart = nothing.hulls = nothing.props = false;
    nothing.contacts = nothing.particles = nothing.ground = false;
    camera.eye = {1.5, 1.5, 3.3};
    camera.target = {0.0, 0.85, 0.0};
  }

  static bool isFinger(const std::string& name) {
    for (const char* finger : {"Thumb", "Index", "Middle", "Ring", "Little"}) {
      if (name.find(finger) != std::string::npos) return true;
    }
    return false;
  }

  [[nodiscard]] SceneOptions showing(std::string_view what) const {
    SceneOptions show = nothing;
    const auto has = [what](std::string_view word) { return what.find(word) != std::string_view::npos; };
    show.skin = has("skin");
    show.colorSkinByPart = has("colours");
    show.hulls = has("hulls");
    show.bones = has("bones");
    show.props = has("props");
    show.contacts = has("contacts");
    show.particles = has("particles");
    show.ground = has("ground");
    if (has("caption")) show.caption = "walk   1.5 s   16 convex parts";
    if (has("panel")) show.panel = "pose\t0.12 ms\nhulls\t0.40 ms\nphysics\t0.31 ms";
    return show;
  }

  [[nodiscard]] Image drawn(test::Studio& studio, std::string_view what) const {
    Scene shown = scene;
    if (what.find("inset") != std::string_view::npos) shown.inset = &inset;
    return studio.draw(shown, showing(what), camera, kWidth, kHeight);
  }
};

/// What to draw with an overlay, and without it.
struct Overlay {
  const char* name;
  const char* with;
  const char* without;
};

class GoldenOverlay : public Golden, public ::testing::WithParamInterface<Overlay> {};

TEST_P(GoldenOverlay, IsAsItWas) {
  const auto& [name, with, without] = GetParam();
  LORICA_REQUIRE_STUDIO(studio, "");
  test::expectGolden(name, drawn(*studio, with));
  // Without the overlay the comparison must fail, otherwise it would not detect a missing overlay.
  EXPECT_GT(test::pictureError(drawn(*studio, without), test::readGolden(name)).wrong, 4.0 * test::kMaxWrong)
      << name << ": the comparison does not detect the missing overlay";
}

INSTANTIATE_TEST_SUITE_P(
    Each, GoldenOverlay,
    ::testing::Values(Overlay{"skin", "skin", ""}, Overlay{"parts", "skin colours", "skin"},
                      Overlay{"hulls", "skin hulls", "skin"}, Overlay{"bones", "skin bones", "skin"},
                      Overlay{"props", "ground props", "ground"}, Overlay{"contacts", "skin contacts", "skin"},
                      Overlay{"ground", "skin props ground", "skin props"},
                      Overlay{"particles", "skin ground particles", "skin ground"}, Overlay{"inset", "inset", ""},
                      Overlay{"caption", "caption", ""}, Overlay{"panel", "panel", ""}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(PictureError, SmallDifferencesAreNone) {
  Image a{40, 30, std::vector<std::uint8_t>(40 * 30 * 4, 200)};
  for (int y = 0; y < 30; ++y) {
    for (int x = 10; x < 20; ++x) a.rgba[4 * (40 * y + x)] = 20;
  }
  EXPECT_EQ(test::pictureError(a, a).wrong, 0.0);
  Image moved = a;
  std::rotate(moved.rgba.begin(), moved.rgba.begin() + 4, moved.rgba.end());  // by one pixel
  EXPECT_EQ(test::pictureError(a, moved).wrong, 0.0);
  Image darker = a;
  for (std::uint8_t& c : darker.rgba) c = static_cast<std::uint8_t>(std::max(0, c - 35));
  EXPECT_EQ(test::pictureError(a, darker).wrong, 0.0);
}

TEST(PictureError, IsTheShareOfPixelsThatHaveNothingLikeThemNearby) {
  const Image white{40, 30, std::vector<std::uint8_t>(40 * 30 * 4, 255)};
  Image square = white;
  for (int y = 5; y < 15; ++y) {
    for (int x = 8; x < 20; ++x) square.rgba[4 * (40 * y + x) + 1] = 0;
  }
  EXPECT_DOUBLE_EQ(test::pictureError(white, square).wrong, 10.0 * 12.0 / (40.0 * 30.0));
  EXPECT_DOUBLE_EQ(test::pictureError(square, white).wrong, 10.0 * 12.0 / (40.0 * 30.0));
  const Image other{30, 40, std::vector<std::uint8_t>(40 * 30 * 4, 255)};
  EXPECT_EQ(test::pictureError(white, other).wrong, 1.0);
  // A missing line of one pixel width is detected in both directions.
  Image line = white;
  for (int y = 0; y < 30; ++y) line.rgba[4 * (40 * y + 7)] = 0;
  EXPECT_DOUBLE_EQ(test::pictureError(white, line).wrong, 1.0 / 40.0);
  EXPECT_DOUBLE_EQ(test::pictureError(line, white).wrong, 1.0 / 40.0);
}

}  // namespace
}  // namespace lorica
