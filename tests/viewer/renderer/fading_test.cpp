// Figures that fade: the share of their pixels, and that of their hulls.

#include "tests/support/meshes.h"
#include "tests/viewer/renderer/avatar_squares.h"
#include "viewer/renderer/overlay_mesh.h"

#include <gtest/gtest.h>

#include <vector>

namespace lorica {
namespace {

using test::differingPixels;
using test::frontCamera;

/// The share of a figure's pixels that are drawn at an opacity.
double shareDrawn(test::Studio& studio, Scene scene, float opacity) {
  SceneOptions show;
  show.hulls = show.ground = false;
  show.colorSkinByPart = false;
  show.background = Vec3f::Zero();
  const auto draw = [&](float visible) {
    scene.opacity = visible;
    return studio.draw(scene, show, frontCamera(), 240, 180);
  };
  const Image empty = studio.draw(Scene(), show, frontCamera(), 240, 180), whole = draw(1.0f), drawn = draw(opacity);
  EXPECT_EQ(draw(opacity).rgba, drawn.rgba) << "the same pattern in each picture";
  const int all = differingPixels(whole, empty, 8);
  EXPECT_GT(all, 2000);
  return static_cast<double>(differingPixels(drawn, empty, 8)) / all;
}

TEST(Fading, DrawsThatShareOfTheSkinsPixels) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const TriMesh box = test::makeBox({-0.5, 0.6, -0.3}, {0.5, 1.4, 0.3});
  Scene scene;
  scene.vertices = box.vertices;
  scene.triangles = box.triangles;
  for (const float opacity : {0.0f, 0.1f, 0.5f, 0.9f, 0.999f}) {
    EXPECT_NEAR(shareDrawn(*studio, scene, opacity), opacity, 0.03) << opacity;
  }
}

TEST(Fading, DrawsThatShareOfAnAvatarsPixelsWhateverItsMaterial) {
  LORICA_REQUIRE_STUDIO(studio, "");
  for (const AlphaMode mode : {AlphaMode::kOpaque, AlphaMode::kMask, AlphaMode::kBlend}) {
    for (const Shading shading : {Shading::kUnlit, Shading::kPhysical, Shading::kToon}) {
      test::AvatarMaker maker;
      Material material;
      material.shading = shading;
      material.alpha = mode;
      maker.material(material);
      maker.add({});
      const test::AvatarOnStage stage(maker.avatar);
      EXPECT_NEAR(shareDrawn(*studio, stage.scene(), 0.4f), 0.4, 0.03)
          << static_cast<int>(mode) << " " << static_cast<int>(shading);
    }
  }
}

TEST(Fading, HullsGetThatShareOfTheirOpacity) {
  const std::vector<LivePart> parts = {test::boxPart({-0.5, 0.5, -0.5}, {0.5, 1.5, 0.5})};
  OverlayMesh mesh;
  const std::vector<OverlayVertex> whole = mesh.hulls(parts, {4, 5, 6});
  const HullFigure fades{parts, 0.5f};
  const std::vector<OverlayVertex>& half = mesh.hulls(std::span(&fades, 1), {4, 5, 6});
  ASSERT_EQ(half.size(), whole.size());
  for (std::size_t i = 0; i < half.size(); ++i) EXPECT_NEAR(half[i].color[3], 0.5 * whole[i].color[3], 1.0);
}

}  // namespace
}  // namespace lorica
