#include "tests/support/meshes.h"
#include "tests/viewer/renderer/pictures.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace lorica {
namespace {

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

}  // namespace
}  // namespace lorica
