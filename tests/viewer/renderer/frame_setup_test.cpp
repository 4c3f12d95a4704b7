#include "viewer/renderer/frame_setup.h"

#include "tests/support/meshes.h"
#include "tests/viewer/renderer/pictures.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

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

}  // namespace
}  // namespace lorica
