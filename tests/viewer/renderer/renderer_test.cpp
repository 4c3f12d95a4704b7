#include "viewer/renderer/renderer.h"

#include "tests/support/meshes.h"
#include "tests/viewer/renderer/picture_error.h"
#include "tests/viewer/renderer/pictures.h"
#include "viewer/renderer/frame_setup.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica {
namespace {

constexpr int kWidth = 240;
constexpr int kHeight = 180;
using test::differingPixels;
using test::frontCamera;
using test::pixelAt;

Prop boxProp(const Vec3& center, double half, const Vec3f& color) {
  Prop prop;
  prop.halfExtents = Vec3::Constant(half);
  prop.worldFromProp.translation() = center;
  prop.color = color;
  return prop;
}

/// A sphere as skin in two parts, a hull next to it, props, contacts and two bones.
struct Studio : ::testing::Test {
  TriMesh mesh = test::makeSphere(0.35, 32, 48);
  std::vector<PartIndex> partOfTriangle;
  std::vector<LivePart> parts = {test::boxPart({0.6, 0.8, -0.1}, {0.8, 1.0, 0.1})};
  std::vector<Prop> props = {boxProp({-0.7, 0.1, 0.2}, 0.1, {0.8f, 0.4f, 0.1f})};
  std::vector<Contact> contacts = std::vector<Contact>(1);
  std::vector<Joint> joints = std::vector<Joint>(2);
  std::optional<Skeleton> skeleton;
  std::vector<Affine3> world = std::vector<Affine3>(2, Affine3::Identity());
  Scene scene;

  Studio() {
    for (Vec3& v : mesh.vertices) v.y() += 1.0;
    for (const Triangle& t : mesh.triangles) {
      partOfTriangle.push_back(mesh.vertices[t[0]].y() > 1.0 ? 0 : 1);
    }
    contacts[0].point = {-0.7, 0.5, 0.5};
    joints[0].name = "root";
    joints[1].name = "tip";
    joints[1].parent = 0;
    skeleton.emplace(Skeleton::create(joints).value());
    world[0].translation() = Vec3(0, 0.8, 0);
    world[1].translation() = Vec3(0, 1.2, 0);
    scene.vertices = mesh.vertices;
    scene.triangles = mesh.triangles;
    scene.partOfTriangle = partOfTriangle;
    scene.parts = parts;
    scene.props = props;
    scene.contacts = contacts;
    scene.skeleton = &*skeleton;
    scene.worldFromJoint = world;
  }
};

TEST_F(Studio, TheSecondEyeSeesWhatACameraThereSees) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const Camera left = frontCamera();
  Camera right = left;
  right.eye.x() += 0.064;
  right.target.x() += 0.064;
  const Image fromLeft = studio->draw(scene, {}, left, kWidth, kHeight);
  const Image fromRight = studio->drawAgain(scene, {}, right);
  EXPECT_GT(differingPixels(fromLeft, fromRight, 40), 100);
  const Image alone = studio->draw(scene, {}, right, kWidth, kHeight);
  EXPECT_LT(test::pictureError(fromRight, alone).wrong, test::kMaxWrong);
}

TEST_F(Studio, ARedBoxIsRedInTheMiddleAndBackgroundInTheCorners) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const std::vector<Prop> red = {boxProp({0, 1, 0}, 0.3, {0.8f, 0.05f, 0.05f})};
  Scene only;
  only.props = red;
  const Image with = studio->draw(only, {}, frontCamera(), kWidth, kHeight);
  const Image without = studio->draw({}, {}, frontCamera(), kWidth, kHeight);
  ASSERT_EQ(with.width, kWidth);
  ASSERT_EQ(with.height, kHeight);
  const auto middle = pixelAt(with, kWidth / 2, kHeight / 2);
  EXPECT_GT(middle[0], 120);
  EXPECT_GT(middle[0], 2 * middle[1]);
  EXPECT_GT(middle[0], 2 * middle[2]);
  for (const int x : {0, kWidth - 1}) {
    for (const int y : {0, kHeight - 1}) EXPECT_EQ(pixelAt(with, x, y), pixelAt(without, x, y));
  }
  const auto sky = pixelAt(without, 0, 0);
  EXPECT_GT(*std::min_element(sky.begin(), sky.end()), 150) << "a light studio";
}

TEST_F(Studio, PicturesAreNotUpsideDownOrMirrored) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const Vec3 position(0.5, 1.3, 0.0);
  const std::vector<Prop> red = {boxProp(position, 0.1, {0.8f, 0.05f, 0.05f})};
  Scene only;
  only.props = red;
  const Image image = studio->draw(only, {}, frontCamera(), kWidth, kHeight);
  double sumX = 0, sumY = 0;
  int n = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto p = pixelAt(image, x, y);
      if (p[0] < 2 * p[1]) continue;
      sumX += x + 0.5;
      sumY += y + 0.5;
      ++n;
    }
  }
  ASSERT_GT(n, 50);
  const auto [x, y] = test::seenAt(position + Vec3(0, 0, 0.1), kWidth, kHeight);
  EXPECT_NEAR(sumX / n, x, 2.0);
  EXPECT_NEAR(sumY / n, y, 2.0);
}

TEST_F(Studio, WhatIsNearHidesWhatIsFar) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const Prop red = boxProp({0, 1, 0.5}, 0.2, {0.8f, 0.05f, 0.05f});
  const Prop blue = boxProp({0, 1, -0.5}, 0.2, {0.05f, 0.05f, 0.8f});
  for (const std::vector<Prop>& order : {std::vector<Prop>{red, blue}, std::vector<Prop>{blue, red}}) {
    Scene only;
    only.props = order;
    const auto middle = pixelAt(studio->draw(only, {}, frontCamera(), kWidth, kHeight), kWidth / 2, kHeight / 2);
    EXPECT_GT(middle[0], 2 * middle[2]);
  }
}

TEST_F(Studio, HullsChangeThePictureOnlyWhereTheyAre) {
  LORICA_REQUIRE_STUDIO(studio, "");
  SceneOptions options;
  const Image with = studio->draw(scene, options, frontCamera(), kWidth, kHeight);
  options.hulls = false;
  const Image without = studio->draw(scene, options, frontCamera(), kWidth, kHeight);
  double left = kWidth, right = 0, top = kHeight, bottom = 0;
  for (const Vec3& v : parts[0].shape.vertices) {
    const auto [x, y] = test::seenAt(v, kWidth, kHeight);
    left = std::min(left, x), right = std::max(right, x), top = std::min(top, y), bottom = std::max(bottom, y);
  }
  int inside = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (pixelAt(with, x, y) == pixelAt(without, x, y)) continue;
      EXPECT_TRUE(x > left - 4 && x < right + 4 && y > top - 4 && y < bottom + 4) << x << ", " << y;
      ++inside;
    }
  }
  EXPECT_GT(inside, 0.8 * (right - left) * (bottom - top));
}

TEST_F(Studio, SkinShowsThroughHulls) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const std::vector<LivePart> around = {test::boxPart({-0.5, 0.5, -0.5}, {0.5, 1.5, 0.5})};
  scene.parts = around;
  SceneOptions options;
  options.colorSkinByPart = false;
  const Image both = studio->draw(scene, options, frontCamera(), kWidth, kHeight);
  options.skin = false;
  const Image hullOnly = studio->draw(scene, options, frontCamera(), kWidth, kHeight);
  const auto a = pixelAt(both, kWidth / 2, kHeight / 2);
  const auto b = pixelAt(hullOnly, kWidth / 2, kHeight / 2);
  EXPECT_GT(std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]), 40);
}

TEST_F(Studio, EveryOptionChangesThePicture) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const auto draw = [&](const SceneOptions& o) { return studio->draw(scene, o, frontCamera(), kWidth, kHeight); };
  const Image plain = draw({});
  for (bool SceneOptions::*flag :
       {&SceneOptions::skin, &SceneOptions::colorSkinByPart, &SceneOptions::hulls, &SceneOptions::bones,
        &SceneOptions::props, &SceneOptions::contacts, &SceneOptions::ground}) {
    SceneOptions options;
    options.*flag = !(options.*flag);
    EXPECT_GT(differingPixels(plain, draw(options), 8), 20);
  }
  for (std::string SceneOptions::*text : {&SceneOptions::caption, &SceneOptions::panel}) {
    SceneOptions options;
    options.*text = "words";
    const Image words = draw(options);
    EXPECT_GT(differingPixels(plain, words, 8), 50);
    const bool low = text == &SceneOptions::caption;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (pixelAt(plain, x, y) == pixelAt(words, x, y)) continue;
        EXPECT_EQ(y > kHeight / 2, low);
        EXPECT_LT(x, kWidth / 2);
      }
    }
  }
  EXPECT_EQ(draw({}).rgba, plain.rgba) << "nothing of them remains";
}

TEST_F(Studio, AnInsetIsAtTheLowerRightUprightAndOpaque) {
  LORICA_REQUIRE_STUDIO(studio, "");
  // Quarters: red and green above blue and white.
  Image inset{2, 2, {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255}};
  const Image plain = studio->draw(scene, {}, frontCamera(), kWidth, kHeight);
  scene.inset = &inset;
  const Image with = studio->draw(scene, {}, frontCamera(), kWidth, kHeight);
  const int side = kWidth / 4, margin = 6;
  const int left = kWidth - margin - side, top = kHeight - margin - side;
  using Pixel = decltype(pixelAt(with, 0, 0));
  EXPECT_EQ(pixelAt(with, left + 5, top + 5), (Pixel{255, 0, 0}));
  EXPECT_EQ(pixelAt(with, left + side - 5, top + 5), (Pixel{0, 255, 0}));
  EXPECT_EQ(pixelAt(with, left + 5, top + side - 5), (Pixel{0, 0, 255}));
  EXPECT_EQ(pixelAt(with, left + side - 5, top + side - 5), (Pixel{255, 255, 255}));
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool inside = x >= left && x < left + side && y >= top && y < top + side;
      if (inside) continue;
      ASSERT_EQ(pixelAt(plain, x, y), pixelAt(with, x, y)) << x << ", " << y;
    }
  }
}

TEST_F(Studio, PartColorsAreSeenOnTheSkin) {
  LORICA_REQUIRE_STUDIO(studio, "");
  SceneOptions options;
  options.hulls = false;
  const Image image = studio->draw(scene, options, frontCamera(), kWidth, kHeight);
  const auto [x, top] = test::seenAt({0, 1.15, 0.3}, kWidth, kHeight);
  const auto [same, low] = test::seenAt({0, 0.85, 0.3}, kWidth, kHeight);
  const auto a = pixelAt(image, static_cast<int>(x), static_cast<int>(top));
  const auto b = pixelAt(image, static_cast<int>(same), static_cast<int>(low));
  // The channels have the same order as in the parts' own colours.
  for (const auto& [pixel, part] : {std::pair{a, 0}, std::pair{b, 1}}) {
    const Vec3f color = partColor(part);
    Eigen::Index max = 0, min = 0;
    color.maxCoeff(&max);
    color.minCoeff(&min);
    EXPECT_GT(pixel[max], pixel[min] + 10);
  }
}

TEST_F(Studio, ThingsCastShadowsOnTheFloorWhereTheLightPutsThem) {
  LORICA_REQUIRE_STUDIO(studio, "");
  SceneOptions options;
  options.hulls = options.props = options.contacts = false;
  Camera camera;
  camera.eye = {0, 4, 5};
  camera.target = {0, 0.5, 0};
  const Image lit = studio->draw({}, options, camera, kWidth, kHeight);
  const Image image = studio->draw(scene, options, camera, kWidth, kHeight);
  const FrameSetup setup = setUpFrame(scene, options, camera, kWidth, kHeight, 256);
  const Vec3f light = setup.uniforms.toLight.head<3>();
  const Vec3f center(0, 1, 0);
  const Vec3f fallen = center - light / light.y();
  const Eigen::Vector4f c = setup.uniforms.clipFromWorld * Eigen::Vector4f(fallen.x(), 0, fallen.z(), 1);
  const int x = static_cast<int>(0.5f * kWidth * (1 + c.x() / c.w()));
  const int y = static_cast<int>(0.5f * kHeight * (1 - c.y() / c.w()));
  EXPECT_LT(pixelAt(image, x, y)[0], pixelAt(lit, x, y)[0] - 25);
  EXPECT_NEAR(pixelAt(image, 2, kHeight - 3)[0], pixelAt(lit, 2, kHeight - 3)[0], 3);
}

TEST_F(Studio, ThingsOnTheFloorDarkenItAroundThem) {
  LORICA_REQUIRE_STUDIO(studio, "");
  // Next to the box on the side of the light, where there is no cast shadow.
  Camera camera;
  camera.eye = {0, 20, 0.5};  // from high above, so that the raised box does not hide the position
  camera.target = {0, 0, 0};
  camera.verticalFov = 0.08;
  const auto brightness = [&](double height) {
    const std::vector<Prop> one = {boxProp({0, 0.2 + height, 0}, 0.2, {0.5f, 0.5f, 0.5f})};
    Scene only;
    only.props = one;
    const FrameSetup setup = setUpFrame(only, {}, camera, kWidth, kHeight, 256);
    const Eigen::Vector4f c = setup.uniforms.clipFromWorld * Eigen::Vector4f(-0.215f, 0, 0.05f, 1);
    const Image image = studio->draw(only, {}, camera, kWidth, kHeight);
    return pixelAt(image, static_cast<int>(0.5f * kWidth * (1 + c.x() / c.w())),
                   static_cast<int>(0.5f * kHeight * (1 - c.y() / c.w())))[1];
  };
  EXPECT_LT(brightness(0.0), brightness(0.6) - 8);
}

TEST_F(Studio, BonesShineThroughTheSkin) {
  LORICA_REQUIRE_STUDIO(studio, "");
  SceneOptions options;
  const Image without = studio->draw(scene, options, frontCamera(), kWidth, kHeight);
  options.bones = true;
  const Image with = studio->draw(scene, options, frontCamera(), kWidth, kHeight);
  EXPECT_NE(pixelAt(with, kWidth / 2, kHeight / 2), pixelAt(without, kWidth / 2, kHeight / 2));
}

TEST_F(Studio, PartsInsideAStaticBodyShineThroughItAndOthersDoNot) {
  LORICA_REQUIRE_STUDIO(studio, "");
  SceneOptions options;
  options.skin = options.contacts = options.ground = false;
  parts = {test::boxPart({-0.1, 0.8, -0.1}, {0.1, 1.2, 0.1})};
  scene.parts = parts;
  props = {boxProp({0.0, 1.0, 0.2}, 0.4, {0.5f, 0.5f, 0.5f})};
  scene.props = props;
  const auto draw = [&] { return studio->draw(scene, options, frontCamera(), kWidth, kHeight); };
  const Image movable = draw();
  scene.parts = {};
  EXPECT_EQ(differingPixels(draw(), movable, 8), 0) << "a movable box hides what is in it";
  scene.parts = parts;
  props[0].mass = 0.0;
  const Image seen = draw();
  const auto covers = [&](double x, double y) {
    const auto [column, row] = test::seenAt({x, y, 0.1}, kWidth, kHeight);
    const auto a = pixelAt(seen, static_cast<int>(column), static_cast<int>(row));
    const auto b = pixelAt(movable, static_cast<int>(column), static_cast<int>(row));
    return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]) > 12;
  };
  EXPECT_TRUE(covers(0.0, 1.0)) << "a tint of the part";
  EXPECT_TRUE(covers(0.1, 1.0)) << "its outline";
  EXPECT_FALSE(covers(0.2, 1.0)) << "the rest of the wall is as it was";
  // Behind the wall, or touching it: nothing to tell.
  parts = {test::boxPart({-0.1, 0.8, -0.5}, {0.1, 1.2, -0.19})};
  scene.parts = parts;
  EXPECT_EQ(differingPixels(draw(), movable, 8), 0);
}

TEST_F(Studio, TheSameSceneGivesTheSameBytes) {
  LORICA_REQUIRE_STUDIO(studio, "");
  SceneOptions options;
  options.bones = true;
  options.caption = "twice";
  const Image first = studio->draw(scene, options, frontCamera(), kWidth, kHeight);
  EXPECT_EQ(studio->draw(scene, options, frontCamera(), kWidth, kHeight).rgba, first.rgba);
  // Other sizes and scenes in between leave no traces.
  (void)studio->draw({}, {}, {}, 33, 77);
  EXPECT_EQ(studio->draw(scene, options, frontCamera(), kWidth, kHeight).rgba, first.rgba);
}

TEST_F(Studio, EmptyScenesAndTinyPicturesAreNoTrouble) {
  LORICA_REQUIRE_STUDIO(studio, "");
  SceneOptions all;
  all.bones = true;
  all.caption = "caption";
  all.panel = "panel\nof two lines";
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 5}, {1, 300}, {300, 1}}) {
    for (const Scene& s : {Scene{}, scene}) {
      const Image image = studio->draw(s, all, frontCamera(), width, height);
      EXPECT_EQ(image.width, width);
      EXPECT_EQ(image.height, height);
      EXPECT_EQ(image.rgba.size(), static_cast<std::size_t>(width) * height * 4);
      for (std::size_t i = 3; i < image.rgba.size(); i += 4) EXPECT_EQ(image.rgba[i], 255);
    }
  }
}

TEST_F(Studio, NumbersThatAreNotFiniteDoNotSpreadOverThePicture) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const Image whole = studio->draw(scene, {}, frontCamera(), kWidth, kHeight);
  mesh.vertices[100].x() = std::numeric_limits<double>::quiet_NaN();
  contacts[0].point.y() = std::numeric_limits<double>::quiet_NaN();
  props.push_back(boxProp(Vec3::Constant(std::numeric_limits<double>::infinity()), 0.1, Vec3f::Ones()));
  scene.props = props;
  const Image broken = studio->draw(scene, {}, frontCamera(), kWidth, kHeight);
  EXPECT_LT(differingPixels(whole, broken, 64), kWidth * kHeight / 20);
}

TEST_F(Studio, EdgesAreSmoothed) {
  LORICA_REQUIRE_STUDIO(studio, "");
  // A rotated box in front of the sky: its border must have intermediate colours.
  std::vector<Prop> one = {boxProp({0, 1.2, 0}, 0.3, {0.02f, 0.02f, 0.02f})};
  one[0].worldFromProp.rotate(Eigen::AngleAxisd(0.3, Vec3::UnitZ()));
  Scene only;
  only.props = one;
  SceneOptions options;
  options.ground = false;
  const Image image = studio->draw(only, options, frontCamera(), kWidth, kHeight);
  int between = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) between += pixelAt(image, x, y)[1] > 110 && pixelAt(image, x, y)[1] < 180;
  }
  EXPECT_GT(between, 60);
}

TEST(Renderer, ALibraryWithoutOpenGlIsRefusedByName) {
  const Result<Renderer> renderer = Renderer::create([](const char*) -> void* { return nullptr; });
  ASSERT_FALSE(renderer.ok());
  EXPECT_EQ(renderer.error().code, ErrorCode::kNoDisplay);
  EXPECT_NE(renderer.error().message.find("gl"), std::string::npos);
}

TEST(Renderer, ATransparentPictureHoldsWhatIsDrawnAlone) {
  LORICA_REQUIRE_STUDIO(studio, "");
  const TriMesh box = test::makeBox({-0.3, 0.7, -0.3}, {0.3, 1.3, 0.3});
  const std::vector<LivePart> parts = {test::boxPart({-0.6, 0.4, -0.6}, {0.6, 1.6, 0.6})};
  Scene scene;
  scene.vertices = box.vertices;
  scene.triangles = box.triangles;
  scene.parts = parts;
  SceneOptions options;
  options.ground = false;
  const Image opaque = studio->draw(scene, options, test::frontCamera(), 160, 120);
  options.transparent = true;
  const Image image = studio->draw(scene, options, test::frontCamera(), 160, 120);
  const auto alpha = [&](const Vec3& point) {
    const auto [x, y] = test::seenAt(point, 160, 120);
    return int{image.rgba[4 * (static_cast<std::size_t>(std::lround(y)) * 160 + std::lround(x)) + 3]};
  };
  EXPECT_EQ(image.rgba[3], 0) << "beside";
  EXPECT_EQ(alpha({0.0, 1.0, 0.3}), 255) << "the box";
  const int hull = alpha({0.5, 1.0, 0.6});
  EXPECT_GT(hull, 20);
  EXPECT_LT(hull, 200);
  for (std::size_t i = 3; i < opaque.rgba.size(); i += 4) ASSERT_EQ(opaque.rgba[i], 255);
  options.hulls = false;
  const Image plain = studio->draw(scene, options, test::frontCamera(), 160, 120);
  for (std::size_t i = 0; i < plain.rgba.size(); i += 4) {  // edges are as bright as what they belong to
    const bool edge = plain.rgba[i + 3] > 40 && plain.rgba[i + 3] < 255;
    EXPECT_TRUE(!edge || plain.rgba[i] + plain.rgba[i + 2] > 100);
  }
}

}  // namespace
}  // namespace lorica
