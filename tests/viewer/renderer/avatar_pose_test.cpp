#include "skinning/linear_blend.h"
#include "skinning/look/expressed_materials.h"
#include "tests/viewer/renderer/avatars.h"
#include "tests/viewer/renderer/pictures.h"
#include "viewer/renderer/avatar_mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace lorica {
namespace {

using test::AvatarMaker;
using test::AvatarOnStage;
using test::byteOf;

// Avatars in poses, with expressions, one after the other.

constexpr int kWidth = 240;
constexpr int kHeight = 180;
using test::AvatarMaker;
using test::AvatarOnStage;
using test::onBlack;

Material chalk() {
  Material material;
  material.baseColor = {0.6f, 0.6f, 0.6f, 1.0f};
  material.metallic = 0.0f;
  return material;
}

/// A ball; the large one has so many vertices that software renderers skin it on the CPU.
AvatarMaker ball(int joints, bool large) {
  AvatarMaker maker(joints);
  maker.material(chalk());
  maker.addSphere({0, 1, 0}, 0.45, large ? 64 : 24, large ? 96 : 32);
  return maker;
}

Affine3 turn(double angle, const Vec3& axis, const Vec3& by) {
  Affine3 made = Affine3::Identity();
  made.translate(Vec3(0, 1, 0) + by).rotate(Eigen::AngleAxisd(angle, axis.normalized())).translate(Vec3(0, -1, 0));
  return made;
}

void pose(AvatarOnStage& stage, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto number = [&] { return static_cast<double>(random() % 2001) / 1000.0 - 1.0; };
  for (Affine3& matrix : stage.worldFromModel) {
    matrix = turn(0.8 * number(), Vec3(number(), number(), number() + 2.0), 0.15 * Vec3(number(), number(), number()));
  }
}

Image drawn(test::Studio& studio, const AvatarOnStage& stage) {
  return studio.draw(stage.scene(), onBlack(), test::frontCamera(), kWidth, kHeight);
}

/// Pixels that belong to one of two silhouettes only.
int silhouettesDiffer(const Image& a, const Image& b) {
  int count = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) count += (test::pixelAt(a, x, y)[0] > 20) != (test::pixelAt(b, x, y)[0] > 20);
  }
  return count;
}

TEST(AvatarPose, IsThatOfLinearBlendSkinning) {
  LORICA_REQUIRE_STUDIO(studio, "");
  for (const bool large : {false, true}) {
    for (const auto& [joints, influences] : {std::pair{1, 1}, {2, 2}, {6, 4}, {9, 8}, {500, 6}}) {
      AvatarMaker maker = ball(joints, large);
      maker.spreadInfluences(influences, 7);
      AvatarOnStage stage(maker.avatar);
      pose(stage, 42);
      const Image found = drawn(*studio, stage);
      // The same, posed beforehand, on one joint that does not move.
      AvatarMaker fixed = ball(1, large);
      skinLinearBlend(stage.avatar->character, stage.worldFromModel, fixed.avatar.character.mesh.vertices);
      const Image expected = drawn(*studio, AvatarOnStage(fixed.avatar));
      EXPECT_LE(silhouettesDiffer(found, expected), 12) << joints << " joints, " << influences << " influences";
    }
  }
}

TEST(AvatarPose, NormalsTurnWithTheJoints) {
  LORICA_REQUIRE_STUDIO(studio, "");
  for (const bool large : {false, true}) {
    AvatarMaker maker = ball(3, large);
    maker.spreadInfluences(2, 3);
    AvatarOnStage stage(maker.avatar);
    const Image before = drawn(*studio, stage);
    for (Affine3& matrix : stage.worldFromModel) matrix = turn(1.1, Vec3(1, 2, -1), Vec3::Zero());
    EXPECT_LE(test::differingPixels(before, drawn(*studio, stage), 24), kWidth * kHeight / 100)
        << "a ball looks the same from all sides";
  }
}

TEST(AvatarPose, OfMoreThanEightInfluencesTheHeaviestAreKept) {
  AvatarMaker maker = ball(30, false);
  maker.spreadInfluences(20, 5);
  const AvatarMesh mesh = makeAvatarMesh(maker.avatar);
  EXPECT_FALSE(mesh.fewInfluences);
  const Character& character = maker.avatar.character;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    std::vector<double> weights;
    for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
      weights.push_back(character.influences[i].weight);
    }
    std::sort(weights.rbegin(), weights.rend());
    double kept = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < kAvatarInfluences; ++i) {
      kept += weights[i];
      sum += mesh.vertices[v].weights[i];
    }
    EXPECT_NEAR(sum, 1.0, 1e-5);
    EXPECT_NEAR(mesh.vertices[v].weights[0], weights[0] / kept, 1e-5);
    EXPECT_NEAR(mesh.vertices[v].weights[7], weights[7] / kept, 1e-5);
  }
}

TEST(AvatarPose, OnTheCpuEqualsLinearBlendSkinning) {
  AvatarMaker maker = ball(12, true);
  maker.spreadInfluences(5, 11);
  AvatarOnStage stage(maker.avatar);
  pose(stage, 1);
  const AvatarMesh mesh = makeAvatarMesh(*stage.avatar);
  std::vector<Eigen::Vector4f> rows;
  fillJointRows(stage.worldFromModel, rows);
  std::vector<AvatarPosed> posed(mesh.vertices.size());
  poseAvatar(mesh.shapes, mesh.vertices, rows, posed);
  std::vector<Vec3> expected(posed.size());
  skinLinearBlend(stage.avatar->character, stage.worldFromModel, expected);
  for (std::size_t v = 0; v < posed.size(); ++v) {
    ASSERT_LT((posed[v].position.cast<double>() - expected[v]).norm(), 1e-5) << v;
    ASSERT_NEAR(posed[v].normal.norm(), 1.0f, 1e-4f) << v;
  }
}

TEST(AvatarPose, ExpressionsAppearAndGoAwayAgain) {
  LORICA_REQUIRE_STUDIO(studio, "");
  for (const bool large : {false, true}) {
    const AvatarOnStage stage(ball(1, large).avatar);
    const Image before = drawn(*studio, stage);
    std::vector<Vec3> positions = stage.avatar->character.mesh.vertices;
    for (Vec3& p : positions) p.y() = 1.0 + 0.5 * (p.y() - 1.0);
    Scene scene = stage.scene();
    scene.avatarPositions = positions;
    scene.avatarNormals = stage.avatar->look.normals;
    const Image flat = studio->draw(scene, onBlack(), test::frontCamera(), kWidth, kHeight);
    const auto [x, y] = test::seenAt({0, 1.35, 0}, kWidth, kHeight);
    EXPECT_GT(test::pixelAt(before, static_cast<int>(x), static_cast<int>(y))[0], 50);
    EXPECT_EQ(test::pixelAt(flat, static_cast<int>(x), static_cast<int>(y))[0], 0);
    EXPECT_EQ(studio->draw(scene, onBlack(), test::frontCamera(), kWidth, kHeight).rgba, flat.rgba);
    EXPECT_EQ(drawn(*studio, stage).rgba, before.rgba);
  }
}

TEST(AvatarPose, WithoutMatricesThereIsNothingToDraw) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarOnStage stage(ball(2, false).avatar);
  stage.worldFromModel.pop_back();
  const Image image = drawn(*studio, stage);
  EXPECT_EQ(test::pixelAt(image, kWidth / 2, kHeight / 2), (std::array{0, 0, 0}));
}

TEST(AvatarPose, NumbersThatAreNotFiniteDoNotStopTheOthers) {
  LORICA_REQUIRE_STUDIO(studio, "");
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    for (const bool large : {false, true}) {
      AvatarMaker maker(2);
      Material glass = chalk();
      glass.alpha = AlphaMode::kBlend;
      glass.baseColor.w() = 0.8f;
      for (int i = 0; i < 20; ++i) {  // enough to be sorted by more than insertion
        maker.material(glass);
        AvatarMaker::Quad quad;
        quad.center.z() = -0.02 * i;
        maker.add(quad);
      }
      maker.addSphere({0, 1, 0.3}, 0.2, large ? 64 : 8, large ? 64 : 8);
      for (std::size_t i = 0; i < maker.avatar.character.influences.size(); i += 4) {
        if (i % 8 == 0 && i < 80) maker.avatar.character.influences[i].joint = 1;
      }
      AvatarOnStage stage(maker.avatar);
      stage.worldFromModel[1].matrix().setConstant(bad);
      const Image image = drawn(*studio, stage);
      EXPECT_GT(test::pixelAt(image, kWidth / 2, kHeight / 2)[0], 50);
    }
  }
}

TEST(AvatarMemory, AnAvatarTakesThePlaceOfAnother) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarMaker square;
  Material material;
  material.shading = Shading::kUnlit;
  material.base = square.picture({255, 0, 0, 255});
  square.material(material);
  square.add({});
  const AvatarOnStage red(square.avatar), round(ball(1, false).avatar);
  const Image first = drawn(*studio, red), second = drawn(*studio, round);
  EXPECT_GT(test::differingPixels(first, second, 8), 500);
  EXPECT_EQ(drawn(*studio, red).rgba, first.rgba) << "both stay";
  EXPECT_EQ(drawn(*studio, round).rgba, second.rgba);
}

TEST(AvatarMemory, DestroyedAvatarsLeaveNothingBehind) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const auto draw = [&](std::uint8_t green, int squares) {
    AvatarMaker maker;
    for (int i = 0; i < squares; ++i) {
      Material material;
      material.shading = Shading::kUnlit;
      material.base = maker.picture({0, green, 0, 255});
      maker.material(material);
      maker.add({});
    }
    const AvatarOnStage stage(maker.avatar);
    const Image image = drawn(*studio, stage);
    EXPECT_EQ(test::pixelAt(image, kWidth / 2, kHeight / 2)[1], green);
  };
  const auto empty = [&] { (void)studio->draw({}, onBlack(), test::frontCamera(), kWidth, kHeight); };
  draw(255, 4);
  empty();
  const test::Studio::Objects after = studio->objects();
  for (int i = 0; i < 8; ++i) draw(static_cast<std::uint8_t>(10 + i), 1 + i % 4);
  EXPECT_EQ(studio->objects().buffers, after.buffers);
  empty();
  EXPECT_EQ(studio->objects().textures, after.textures);
}

// What expressions change of an avatar's materials, by closed forms.

constexpr int kSize = 96;

/// The middle of a picture with one expression at a weight.
std::array<int, 3> middleWith(test::Studio& studio, const AvatarOnStage& stage, const Expression& expression,
                              float weight, const AvatarLight& light = test::dark()) {
  Expressions expressions;
  addExpression(expressions, expression);
  std::vector<Material> shown = stage.avatar->look.materials;
  expressMaterials(expressions, std::array{weight}, stage.avatar->look.materials, shown);
  Scene scene = stage.scene();
  scene.avatarMaterials = shown;
  return test::pixelAt(studio.draw(scene, test::onBlack(light), test::frontCamera(), kSize, kSize), kSize / 2,
                       kSize / 2);
}

void expectColor(const std::array<int, 3>& found, const Vec3f& linear, const std::string& what) {
  for (Eigen::Index c = 0; c < 3; ++c) EXPECT_NEAR(found[c], byteOf(linear[c]), 1) << what << ", channel " << c;
}

/// A material that shows one of its colours and nothing else, in a key light of 1 for shades and without light for
/// other colours.
Material showing(MaterialColor color, const Vec3f& value, AvatarMaker& maker) {
  Material material;
  material.shading = color == MaterialColor::kBase ? Shading::kUnlit : Shading::kToon;
  material.baseColor = {1, 1, 1, 1};
  material.toon.rimLightingMix = 0.0f;
  if (color == MaterialColor::kBase) material.baseColor.head<3>() = value;
  if (color == MaterialColor::kEmission) {
    material.emissive = value;
    material.emissiveStrength = 0.5f;
  }
  if (color == MaterialColor::kShade) {
    material.toon.shadeColor = value;
    material.toon.shift = -2.0f;  // the light reaches nothing
  }
  if (color == MaterialColor::kRim) {
    material.toon.rimColor = value;
    material.toon.rimLift = 1.0f;  // the rim is everywhere
  }
  if (color == MaterialColor::kMatcap) {
    material.toon.matcapFactor = value;
    material.toon.matcap = maker.picture({255, 255, 255, 255});
  } else {
    material.toon.matcapFactor.setZero();
  }
  return material;
}

TEST(AvatarExpression, ColorsAreBlendedLinearlyAndGoBack) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const Vec3f base(0.8f, 0.5f, 0.2f), target(0.1f, 0.9f, 0.6f);
  for (const MaterialColor color : {MaterialColor::kBase, MaterialColor::kEmission, MaterialColor::kShade,
                                    MaterialColor::kRim, MaterialColor::kMatcap}) {
    AvatarMaker maker;
    maker.material(showing(color, base, maker));
    maker.add({});
    const AvatarOnStage stage(maker.avatar);
    AvatarLight light = test::dark();
    if (color == MaterialColor::kShade) light.key.setOnes();
    Expression expression;
    expression.name = "made";
    expression.colors = {{0, color, {target.x(), target.y(), target.z(), 1.0f}}};
    for (const float weight : {0.0f, 0.25f, 1.0f, 0.0f}) {
      const float strength = color == MaterialColor::kEmission ? 0.5f : 1.0f;
      expectColor(middleWith(*studio, stage, expression, weight, light), strength * (base + weight * (target - base)),
                  "colour " + std::to_string(static_cast<int>(color)) + " at " + std::to_string(weight));
    }
  }
}

TEST(AvatarExpression, OpacityIsBlendedOnBlendedMaterials) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarMaker maker;
  Material material;
  material.shading = Shading::kUnlit;
  material.alpha = AlphaMode::kBlend;
  material.baseColor = {1, 1, 1, 0};  // a blush that an expression shows
  maker.material(material);
  maker.add({});
  const AvatarOnStage stage(maker.avatar);
  Expression blush;
  blush.name = "blush";
  blush.colors = {{0, MaterialColor::kBase, {1.0f, 1.0f, 1.0f, 0.8f}}};
  for (const float weight : {0.0f, 0.5f, 1.0f}) {
    EXPECT_NEAR(middleWith(*studio, stage, blush, weight)[0], 255.0f * 0.8f * weight, 1) << weight;
  }
}

TEST(AvatarExpression, OutlinesTakeTheirColor) {
  LORICA_REQUIRE_STUDIO(studio, "");
  AvatarMaker maker;
  Material material;
  material.shading = Shading::kToon;
  material.toon.outline = OutlineMode::kWorld;
  material.toon.outlineWidth = 0.3f;
  material.toon.outlineLightingMix = 0.0f;
  material.toon.outlineColor = {0, 0, 1};
  maker.material(material);
  maker.addSphere({0.5, 1, 0}, 0.4, 32, 48);  // the middle of the picture is in its outline
  const AvatarOnStage stage(maker.avatar);
  Expression expression;
  expression.name = "made";
  expression.colors = {{0, MaterialColor::kOutline, {1.0f, 0.0f, 0.0f, 1.0f}}};
  for (const float weight : {0.0f, 0.3f}) {
    expectColor(middleWith(*studio, stage, expression, weight), Vec3f(weight, 0.0f, 1.0f - weight),
                std::to_string(weight));
  }
}

TEST(AvatarExpression, TextureCoordinatesMove) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const std::array<Vec3f, 4> colors = {Vec3f(1, 0, 0), Vec3f(0, 1, 0), Vec3f(0, 0, 1), Vec3f(1, 1, 1)};
  AvatarMaker maker;
  Material material;
  material.shading = Shading::kUnlit;
  material.base = maker.picture(4, 1, {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 255, 255}});
  maker.material(material);
  AvatarMaker::Quad quad;
  quad.uLeft = quad.uRight = 0.125f;  // red at first
  maker.add(quad);
  const AvatarOnStage stage(maker.avatar);
  Expression moved;
  moved.name = "moved";
  moved.textures = {{0, {1.0f, 1.0f}, {0.5f, 0.0f}}};
  expectColor(middleWith(*studio, stage, moved, 0.0f), colors[0], "at 0");
  expectColor(middleWith(*studio, stage, moved, 0.5f), colors[1], "half");
  expectColor(middleWith(*studio, stage, moved, 1.0f), colors[2], "whole");
  moved.textures = {{0, {5.0f, 1.0f}, {0.0f, 0.0f}}};  // 5 x 0.125: the third texel
  expectColor(middleWith(*studio, stage, moved, 1.0f), colors[2], "scaled");
}

}  // namespace
}  // namespace lorica
