#include "viewer/renderer/frame_setup.h"

#include "tests/support/meshes.h"
#include "tests/viewer/renderer/avatar_squares.h"
#include "tests/viewer/renderer/pictures.h"
#include "viewer/renderer/overlay_mesh.h"
#include "viewer/renderer/scene.h"
#include "viewer/renderer/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

namespace lorica {
namespace {

using test::differingPixels;
using test::frontCamera;

Eigen::Vector4f clip(const FrameSetup& setup, const Vec3& p) {
  return setup.uniforms.clipFromWorld * Eigen::Vector4f(p.cast<float>().homogeneous());
}

TEST(FrameSetup, CameraSeesPointsWhereSimilarTrianglesPutThem) {
  const int width = 320, height = 200;
  const FrameSetup setup = setUpFrame({}, {}, test::frontCamera(), width, height, 256);
  for (const Vec3& p : {Vec3(0, 1, 0), Vec3(0.4, 1.3, 0.5), Vec3(-0.7, 0.2, -2.0), Vec3(0.1, 1.9, 1.5)}) {
    const Eigen::Vector4f c = clip(setup, p);
    const auto [x, y] = test::seenAt(p, width, height);
    EXPECT_NEAR(0.5 * width * (1.0 + c.x() / c.w()), x, 1e-3);
    EXPECT_NEAR(0.5 * height * (1.0 - c.y() / c.w()), y, 1e-3);
    EXPECT_LT(std::abs(c.z()), c.w());
  }
}

TEST(FrameSetup, DepthGrowsAwayFromTheCamera) {
  const FrameSetup setup = setUpFrame({}, {}, test::frontCamera(), 10, 10, 256);
  double last = -1.0;
  for (double z = 3.5; z > -20.0; z -= 0.5) {
    const Eigen::Vector4f c = clip(setup, {0.0, 1.0, z});
    EXPECT_GT(c.z() / c.w(), last);
    last = c.z() / c.w();
  }
}

TEST(FrameSetup, ShadowMapHoldsTheWholeSubject) {
  const TriMesh mesh = test::makeTorus(0.7, 0.2, 24, 12);
  std::vector<Vec3> moved;
  for (int step = 0; step < 20; ++step) {
    moved.clear();
    for (const Vec3& v : mesh.vertices) moved.push_back(v + Vec3(0.173 * step, 0.9, -0.211 * step));
    Scene scene;
    scene.vertices = moved;
    scene.triangles = mesh.triangles;
    const FrameSetup setup = setUpFrame(scene, {}, {}, 100, 100, 256);
    for (const Vec3& v : moved) {
      const Eigen::Vector4f s = setup.uniforms.shadowFromWorld * Eigen::Vector4f(v.cast<float>().homogeneous());
      EXPECT_GE(s.head<3>().minCoeff(), 0.0f);
      EXPECT_LE(s.head<3>().maxCoeff(), 1.0f);
      // Its shadow on the floor is in the part of the floor with shadow lookups.
      const Vec3f light = setup.uniforms.toLight.head<3>();
      const Vec3f fallen = v.cast<float>() - light * (static_cast<float>(v.y()) / light.y());
      EXPECT_GE(fallen.x(), setup.shadedMin.x());
      EXPECT_LE(fallen.x(), setup.shadedMax.x());
      EXPECT_GE(fallen.z(), setup.shadedMin.y());
      EXPECT_LE(fallen.z(), setup.shadedMax.y());
    }
  }
}

TEST(FrameSetup, ShadowTexelsStandStillWhileTheSubjectMoves) {
  // A fixed point must keep its position within a texel, otherwise shadows crawl.
  const TriMesh mesh = test::makeSphere(0.8, 12, 16);
  std::vector<Vec3> moved;
  std::optional<Eigen::Vector2f> first;
  for (int step = 0; step < 10; ++step) {
    moved.clear();
    for (const Vec3& v : mesh.vertices) moved.push_back(v + Vec3(0.0137 * step, 1.0, 0.0071 * step));
    Scene scene;
    scene.vertices = moved;
    scene.triangles = mesh.triangles;
    const FrameSetup setup = setUpFrame(scene, {}, {}, 100, 100, 256);
    const Eigen::Vector2f texel = 256.0f * (setup.uniforms.shadowFromWorld * Eigen::Vector4f(0, 1, 0, 1)).head<2>();
    const Eigen::Vector2f within = texel.array() - texel.array().floor();
    if (!first) first = within;
    for (int k = 0; k < 2; ++k) {
      const float apart = std::abs(within[k] - (*first)[k]);
      EXPECT_LT(std::min(apart, 1.0f - apart), 0.01f);
    }
  }
}

TEST(FrameSetup, NumbersStayFiniteForOddInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vec3> broken = {{nan, 0, 0}, {0, 1, 0}, {1, std::numeric_limits<double>::infinity(), 0}};
  std::vector<Prop> props(1);
  props[0].halfExtents = {nan, 1, 1};
  Scene scene;
  scene.vertices = broken;
  scene.props = props;
  std::vector<Camera> cameras(4);
  cameras[1].eye = cameras[1].target;
  cameras[2].eye = cameras[2].target + Vec3(0, 3, 0);  // straight down
  cameras[3].verticalFov = 0.0;
  for (const Camera& camera : cameras) {
    const FrameSetup setup = setUpFrame(scene, {}, camera, 1, 1, 256);
    EXPECT_TRUE(setup.uniforms.clipFromWorld.allFinite());
    EXPECT_TRUE(setup.uniforms.shadowFromWorld.allFinite());
    EXPECT_TRUE(setup.uniforms.rayRight.allFinite());
    EXPECT_TRUE(setup.uniforms.floorFade.allFinite());
  }
}

/// Linear sRGB to OKLab (B. Ottosson 2020), in which distances are perceptually uniform.
Vec3 oklab(const Vec3f& c) {
  const double l = std::cbrt(0.4122214708 * c.x() + 0.5363325363 * c.y() + 0.0514459929 * c.z());
  const double m = std::cbrt(0.2119034982 * c.x() + 0.6806995451 * c.y() + 0.1073969566 * c.z());
  const double s = std::cbrt(0.0883024619 * c.x() + 0.2817188376 * c.y() + 0.6299787005 * c.z());
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

TEST(PartColor, ThirtyTwoPartsCanBeDistinguished) {
  double nearest = 1.0;
  for (int i = 0; i < 32; ++i) {
    const Vec3f color = partColor(i);
    EXPECT_GE(color.minCoeff(), 0.0f);
    EXPECT_LE(color.maxCoeff(), 1.0f);
    for (int j = 0; j < i; ++j) nearest = std::min(nearest, (oklab(color) - oklab(partColor(j))).norm());
  }
  EXPECT_GT(nearest, 0.05);  // a just noticeable difference is about 0.02
}

TEST(PartColor, NeighboursInOrderDifferStrongly) {
  for (int i = 1; i < 64; ++i) EXPECT_GT((oklab(partColor(i)) - oklab(partColor(i - 1))).norm(), 0.12) << i;
}

TEST(PartColor, AnyIndexGivesAColor) {
  for (const int part : {-1, 1000000, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
    const Vec3f color = partColor(part);
    EXPECT_TRUE(color.allFinite());
    EXPECT_GE(color.minCoeff(), 0.0f);
    EXPECT_LE(color.maxCoeff(), 1.0f);
  }
}

struct Sample {
  TriMesh mesh = test::makeTorus(0.4, 0.15, 64, 32);
  std::vector<LivePart> parts = {test::boxPart({-0.2, 0.6, -0.2}, {0.3, 1.3, 0.4})};
  std::vector<Prop> props = std::vector<Prop>(2);
  Scene scene;
  SceneOptions options;

  Sample() {
    for (Vec3& v : mesh.vertices) v.y() += 1.0;
    props[0].worldFromProp.translation() = Vec3(0.8, 0.1, 0.3);
    props[1].shape = PropShape::kSphere;
    props[1].worldFromProp.translation() = Vec3(-0.8, 0.1, 0.3);
    scene.vertices = mesh.vertices;
    scene.triangles = mesh.triangles;
    scene.parts = parts;
    scene.props = props;
    options.caption = "sample";
  }
};

TEST(Offscreen, UnknownWishIsRefused) {
  setenv("LORICA_OFFSCREEN", "vulkan", 1);
  const Result<OffscreenContext> context = OffscreenContext::create();
  unsetenv("LORICA_OFFSCREEN");
  ASSERT_FALSE(context.ok());
  EXPECT_EQ(context.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(context.error().message.find("vulkan"), std::string::npos);
}

TEST(Offscreen, DescribesItself) {
  LORICA_REQUIRE_STUDIO(studio, "osmesa");
  EXPECT_NE(studio->description().find("OSMesa"), std::string::npos);
}

TEST(Offscreen, OsMesaAndEglAgreeAndTakeTurnsInOneProcess) {
  const Sample sample;
  std::vector<Image> pictures;
  for (const char* kind : {"osmesa", "egl", "osmesa", "egl"}) {
    LORICA_REQUIRE_STUDIO(studio, kind);
    pictures.push_back(studio->draw(sample.scene, sample.options, test::frontCamera(), 320, 240));
  }
  const int wrong = test::differingPixels(pictures[0], pictures[1], 64);
  EXPECT_LT(wrong, 320 * 240 / 100);
  EXPECT_EQ(pictures[0].rgba, pictures[2].rgba);
  EXPECT_EQ(pictures[1].rgba, pictures[3].rgba);
}

// Figures that fade, and props before them: seen through as far as their opacity says, pixel by pixel.

/// The largest difference of a colour of a picture from a mix of two [of 255].
int differenceFromMix(const Image& picture, const Image& front, const Image& behind, float opacity) {
  double most = 0.0;
  for (std::size_t k = 0; k < picture.rgba.size(); ++k) {
    const double mix = opacity * front.rgba[k] + (1.0 - opacity) * behind.rgba[k];
    most = std::max(most, std::abs(picture.rgba[k] - mix));
  }
  return static_cast<int>(std::ceil(most));
}

/// How far a figure that fades is from a mix of it and of what is behind [of 255].
int errorOfFading(test::Studio& studio, Scene scene, float opacity) {
  SceneOptions show;
  show.hulls = show.ground = false;
  show.colorSkinByPart = false;
  const auto draw = [&](float visible) {
    scene.opacity = visible;
    return studio.draw(scene, show, frontCamera(), 240, 180);
  };
  const Image empty = studio.draw(Scene(), show, frontCamera(), 240, 180), whole = draw(1.0f);
  EXPECT_GT(differingPixels(whole, empty, 8), 2000);
  return differenceFromMix(draw(opacity), whole, empty, opacity);
}

TEST(Fading, ASkinIsSeenThrough) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const TriMesh box = test::makeBox({-0.5, 0.6, -0.3}, {0.5, 1.4, 0.3});
  Scene scene;
  scene.vertices = box.vertices;
  scene.triangles = box.triangles;
  for (const float opacity : {0.0f, 0.1f, 0.5f, 0.9f, 0.999f}) {
    EXPECT_LE(errorOfFading(*studio, scene, opacity), 2) << opacity;
  }
}

TEST(Fading, AnAvatarIsSeenThroughWhateverItsMaterial) {
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
      EXPECT_LE(errorOfFading(*studio, stage.scene(), 0.4f), 2)
          << static_cast<int>(mode) << " " << static_cast<int>(shading);
    }
  }
}

TEST(Fading, WhatStandsBeforeTheAvatarIsSeenThrough) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const TriMesh box = test::makeBox({-0.5, 0.6, -0.3}, {0.5, 1.4, 0.3});
  Scene scene;
  scene.vertices = box.vertices;
  scene.triangles = box.triangles;
  Prop before;
  before.halfExtents = {0.2, 0.3, 0.1};
  Prop beside = before;
  const Camera camera = frontCamera();
  before.worldFromProp.translation() = 0.4 * camera.eye + 0.6 * Vec3(0.0, 1.0, 0.0);
  beside.worldFromProp.translation() = Vec3(1.2, 0.3, 0.0);
  SceneOptions show;
  show.ground = false;
  const auto draw = [&](std::initializer_list<Prop> props, bool seenThrough) {
    scene.props = {props.begin(), props.size()};
    scene.unhidden.reset();
    if (seenThrough) scene.unhidden = Aabb{Vec3(-0.5, 0.6, -0.3), Vec3(0.5, 1.4, 0.3)};
    return studio->draw(scene, show, camera, 240, 180);
  };
  const Image empty = draw({beside}, false), solid = draw({before, beside}, false);
  ASSERT_GT(differingPixels(solid, empty, 8), 1000);
  // The prop keeps its shadow; this one casts none on what the camera sees of the figure.
  EXPECT_LE(differenceFromMix(draw({before, beside}, true), solid, empty, 0.2f), 3);
  EXPECT_EQ(draw({beside}, true).rgba, empty.rgba) << "what is beside it stays solid";
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

/// Mean of red, green and blue in some rows [of 255].
double brightness(const Image& image, int fromRow, int toRow) {
  double sum = 0.0;
  for (int y = fromRow; y < toRow; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (const int channel : test::pixelAt(image, x, y)) sum += channel;
    }
  }
  return sum / (3.0 * image.width * (toRow - fromRow));
}

TEST(Stage, TheFloorIsDarkerThanTheSkyInLightAndDark) {
  LORICA_REQUIRE_STUDIO(studio, "");
  std::vector<double> floors;
  for (const bool dark : {false, true}) {
    SceneOptions show;
    show.dark = dark;
    const Image image = studio->draw(Scene(), show, frontCamera(), 240, 180);
    const double sky = brightness(image, 60, 80), floor = brightness(image, 150, 180);
    EXPECT_GT(sky, floor + 15.0) << dark;
    floors.push_back(floor);
  }
  EXPECT_GT(floors[0], 150.0);
  EXPECT_LT(floors[1], 60.0);
}

long ink(const TextMask& mask) {
  return std::accumulate(mask.coverage.begin(), mask.coverage.end(), 0L);
}

TEST(Text, CharactersOfUtf8) {
  EXPECT_EQ(charactersOf("plain 123"), U"plain 123");
  EXPECT_EQ(charactersOf("5 \u00b5s \u2013 3\u00d74"), U"5 \u00b5s \u2013 3\u00d74");
  EXPECT_EQ(charactersOf("\u732b\U0001f600!"), U"\u732b\U0001f600!");
  EXPECT_EQ(charactersOf("a\x01z\n\t"), U"a z\n\t");
  EXPECT_EQ(charactersOf("\xff\xfe"), U"\ufffd\ufffd");  // not UTF-8 at all
  EXPECT_EQ(charactersOf(std::string_view("\u732b").substr(0, 2)), U"\ufffd") << "cut";
}

TEST(Text, SignsBeyondAsciiAreThemselves) {
  for (const char* sign : {"\u00b5", "\u2013", "\u00d7", "\u00e9", "\u0416", "\u03a9"}) {
    EXPECT_NE(drawText(sign, 28).coverage, drawText("?", 28).coverage) << sign;
    EXPECT_NE(drawText(sign, 28).coverage, drawText("\ufffd", 28).coverage) << sign;
    EXPECT_GT(ink(drawText(sign, 28)), 0) << sign;
  }
  EXPECT_GT(ink(drawText("\U000f0000", 28)), 0) << "what no font has is marked";
}

TEST(Text, FitsItsMaskAndGrowsWithIt) {
  const TextMask small = drawText("Lorica", 14);
  const TextMask large = drawText("Lorica", 28);
  EXPECT_EQ(small.height, 14);
  EXPECT_EQ(large.height, 28);
  EXPECT_NEAR(large.width, 2.0 * small.width, 3.0);
  EXPECT_GT(ink(small), 0);
  EXPECT_NEAR(static_cast<double>(ink(large)) / static_cast<double>(ink(small)), 4.0, 0.6);
  // Nothing is clipped: the rim of the mask is empty.
  for (int x = 0; x < large.width; ++x) {
    EXPECT_EQ(large.coverage[x], 0);
    EXPECT_EQ(large.coverage[(large.height - 1) * large.width + x], 0);
  }
}

TEST(Text, LinesGoBelowOneAnother) {
  const TextMask one = drawText("wide line", 20);
  const TextMask two = drawText("wide line\ni", 20);
  EXPECT_EQ(two.height, 2 * one.height);
  EXPECT_EQ(two.width, one.width);
  EXPECT_GT(ink(two), ink(one));
}

TEST(Text, FittedLinesAreNoWiderThanAskedAndLoseNoWord) {
  const std::string text = "jumping_jacks   2.1 s   16 convex parts   touching 3 props   beyond training";
  for (const int width : {90, 120, 200, 276, 400, 2000}) {
    const std::string fitted = fittedText(text, 12, width);
    EXPECT_LE(drawText(fitted, 12).width, width) << fitted;
    std::string joined = fitted;
    std::replace(joined.begin(), joined.end(), '\n', ' ');
    std::istringstream got(joined), wanted(text);
    for (std::string a, b; wanted >> b;) {
      ASSERT_TRUE(got >> a);
      if (width > 90) {
        EXPECT_EQ(a, b);
      }
    }
  }
  EXPECT_EQ(fittedText(text, 12, 2000), text) << "text that fits is unchanged";
  EXPECT_GT(std::ranges::count(fittedText(text, 12, 200), '\n'), 0);
  const std::string cut = fittedText("a_name_without_any_blank_in_it.bvh", 12, 80);
  EXPECT_TRUE(cut.starts_with("a_name") && cut.ends_with("..")) << cut;
  EXPECT_LE(drawText(cut, 12).width, 80);
  EXPECT_EQ(fittedText("", 12, 80), "");
}

TEST(Text, DescendersStayInTheirLine) {
  const TextMask mask = drawText("gjpqy", 24);
  for (int x = 0; x < mask.width; ++x) {
    EXPECT_EQ(mask.coverage[(mask.height - 1) * mask.width + x], 0);
  }
}

TEST(Text, EmptyAndTinyTextIsNoTrouble) {
  EXPECT_EQ(ink(drawText("", 20)), 0);
  EXPECT_GT(drawText("", 20).width, 0);
  EXPECT_EQ(drawText("x", -5).height, 6);
}

TEST(TextDeathTest, WithoutFontsThereIsNoLetteringAndOneNotice) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // a new process, which has asked for no font yet
  const auto drawWithout = [] {
    setenv("LORICA_FONTS", "/nowhere", 1);
    const TextMask mask = drawText("hull", 20);
    std::exit(ink(mask) == 0 && mask.width > 20 ? 0 : 1);
  };
  EXPECT_EXIT(drawWithout(), testing::ExitedWithCode(0), "^lorica: pictures have no lettering[^\n]*\n$");
}

TEST(Text, PanelIsPremultiplied) {
  const Image panel = drawTextPanel("caption", 20);
  int solid = 0;
  for (std::size_t i = 0; i < panel.rgba.size(); i += 4) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_LE(panel.rgba[i + c], panel.rgba[i + 3]);
    solid += panel.rgba[i + 3] > 240;
  }
  EXPECT_GT(solid, 50);
  EXPECT_EQ(panel.rgba[3], 0) << "corners are round";
}

}  // namespace
}  // namespace lorica
