#include "tests/support/meshes.h"
#include "tests/viewer/renderer/pictures.h"
#include "viewer/renderer/overlay_mesh.h"
#include "viewer/renderer/prop_mesh.h"
#include "viewer/renderer/skin_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace lorica {
namespace {

TEST(SkinMesh, NormalsOfASphereAreRadial) {
  const TriMesh sphere = test::makeSphere(1.3, 24, 32);
  SkinMesh skin;
  EXPECT_TRUE(skin.update(sphere.vertices, sphere.triangles, {}));
  ASSERT_EQ(skin.vertices().size(), sphere.vertices.size());
  ASSERT_EQ(skin.indices().size(), 3 * sphere.triangles.size());
  EXPECT_TRUE(skin.closed());
  for (const SkinMesh::Vertex& v : skin.vertices()) EXPECT_GT(v.normal.dot(v.position.normalized()), 0.995f);
}

TEST(SkinMesh, BordersOfPartsKeepPositionAndNormalButNotColor) {
  const TriMesh sphere = test::makeSphere(1.0, 16, 24);
  std::vector<PartIndex> parts;
  for (const Triangle& t : sphere.triangles) {
    parts.push_back(sphere.vertices[t[0]].x() > 0 ? 0 : 1);
  }
  SkinMesh skin;
  skin.update(sphere.vertices, sphere.triangles, parts);
  EXPECT_GT(skin.vertices().size(), sphere.vertices.size());
  std::map<std::array<float, 3>, std::size_t> seen;
  int doubled = 0;
  for (std::size_t i = 0; i < skin.vertices().size(); ++i) {
    const SkinMesh::Vertex& v = skin.vertices()[i];
    const auto [it, fresh] = seen.try_emplace({v.position.x(), v.position.y(), v.position.z()}, i);
    if (fresh) continue;
    ++doubled;
    EXPECT_EQ(v.normal, skin.vertices()[it->second].normal);
    EXPECT_NE(skin.colors()[i], skin.colors()[it->second]);
  }
  EXPECT_EQ(seen.size(), sphere.vertices.size());
  EXPECT_EQ(doubled, static_cast<int>(skin.vertices().size() - sphere.vertices.size()));
  // Every triangle still has the same corners.
  for (std::size_t i = 0; i < skin.indices().size(); ++i) {
    const Vec3& expected = sphere.vertices[sphere.triangles[i / 3][i % 3]];
    EXPECT_EQ(skin.vertices()[skin.indices()[i]].position, expected.cast<float>());
  }
}

TEST(SkinMesh, SeamsOfSplitVerticesAreSmoothAndClosed) {
  const TriMesh sphere = test::makeSphere(1.0, 16, 24);
  TriMesh split;
  for (const Triangle& t : sphere.triangles) {
    const auto base = static_cast<VertexIndex>(split.vertices.size());
    for (const VertexIndex v : t) split.vertices.push_back(sphere.vertices[v]);
    split.triangles.push_back({base, base + 1, base + 2});
  }
  SkinMesh skin;
  skin.update(split.vertices, split.triangles, {});
  EXPECT_TRUE(skin.closed());
  for (const SkinMesh::Vertex& v : skin.vertices()) EXPECT_GT(v.normal.dot(v.position.normalized()), 0.99f);
}

TEST(SkinMesh, RebuildsOnlyWhenTopologyChanges) {
  TriMesh box = test::makeBox(Vec3::Zero(), Vec3::Ones());
  SkinMesh skin;
  EXPECT_TRUE(skin.update(box.vertices, box.triangles, {}));
  for (Vec3& v : box.vertices) v *= 2.0;
  EXPECT_FALSE(skin.update(box.vertices, box.triangles, {}));
  EXPECT_EQ(skin.vertices()[7].position, Vec3f(2, 2, 2));
  const std::vector<PartIndex> parts(box.triangles.size(), 3);
  EXPECT_TRUE(skin.update(box.vertices, box.triangles, parts));
  EXPECT_FALSE(skin.update(box.vertices, box.triangles, parts));
  box.triangles.pop_back();
  EXPECT_TRUE(skin.update(box.vertices, box.triangles, {}));
  EXPECT_FALSE(skin.closed());
}

int edgeCount(const std::vector<OverlayVertex>& vertices) {
  int n = 0;
  for (const OverlayVertex& v : vertices) n += v.normal[3] != 0;
  EXPECT_EQ(n % 6, 0);
  return n / 6;
}

TEST(OverlayMesh, ABoxShowsItsTwelveEdgesAndNoDiagonals) {
  const std::vector<LivePart> parts = {test::boxPart(-Vec3::Ones(), Vec3::Ones())};
  OverlayMesh mesh;
  const std::vector<OverlayVertex>& vertices = mesh.hulls(parts, {4, 5, 6});
  EXPECT_EQ(edgeCount(vertices), 12);
  EXPECT_EQ(vertices.size(), 12u * 3 + 12u * 6);
  for (const OverlayVertex& v : vertices) {
    if (v.normal[3] == 0) continue;
    EXPECT_NEAR((v.position - v.other).norm(), 2.0f, 1e-6f) << "an edge, not a diagonal";
  }
}

TEST(OverlayMesh, ASmoothHullShowsOnlyItsOutline) {
  const double radius = 0.5;
  const TriMesh sphere = test::makeSphere(radius, 40, 60);
  std::vector<LivePart> parts(1);
  parts[0].shape.vertices = sphere.vertices;
  parts[0].shape.triangles = sphere.triangles;
  const Vec3 eye(2.0, 1.0, 3.0);
  OverlayMesh mesh;
  int edges = 0;
  for (const OverlayVertex& v : mesh.hulls(parts, eye)) {
    if (v.normal[3] == 0) continue;
    ++edges;
    // The contour of a sphere seen from the eye e is where p . e = r^2.
    EXPECT_NEAR(v.position.cast<double>().dot(eye.normalized()), radius * radius / eye.norm(), 0.06);
  }
  EXPECT_GT(edges / 6, 30);
  EXPECT_LT(edges / 6, 200);
}

TEST(OverlayMesh, HullsGoFromFarToNearAndFacesThatLookAwayFirst) {
  const std::vector<LivePart> parts = {test::boxPart({-1, -1, 2}, {1, 1, 3}), test::boxPart({-1, -1, -3}, {1, 1, -2})};
  const Vec3 eye(0.3, 0.2, 10);
  OverlayMesh mesh;
  const std::vector<OverlayVertex>& vertices = mesh.hulls(parts, eye);
  ASSERT_GT(vertices.size(), 0u);
  bool nearBegan = false;
  std::array<bool, 2> frontBegan{};
  for (const OverlayVertex& v : vertices) {
    const bool near = v.position.z() > 0;
    EXPECT_TRUE(near || !nearBegan) << "far after near";
    nearBegan |= near;
    if (v.normal[3] != 0) continue;
    const bool front = Vec3(v.normal[0], v.normal[1], v.normal[2]).dot(eye - v.position.cast<double>()) > 0;
    EXPECT_TRUE(front || !frontBegan[near]) << "back after front";
    frontBegan[near] |= front;
  }
}

TEST(OverlayMesh, DegenerateAndBrokenHullsAreLeftOut) {
  std::vector<LivePart> parts(3);
  parts[1] = test::boxPart(Vec3::Zero(), Vec3::Ones());
  parts[1].shape.vertices[3].x() = std::numeric_limits<double>::quiet_NaN();
  OverlayMesh mesh;
  EXPECT_TRUE(mesh.hulls(parts, Vec3::Ones()).empty());
}

TEST(OverlayMesh, BonesReachFromParentToChild) {
  std::vector<Joint> joints(3);
  joints[0].name = "root";
  joints[1].name = "child";
  joints[1].parent = 0;
  joints[2].name = "same place";
  joints[2].parent = 1;
  const Result<Skeleton> skeleton = Skeleton::create(joints);
  ASSERT_TRUE(skeleton.ok());
  std::vector<Affine3> world(3, Affine3::Identity());
  world[1].translation() = world[2].translation() = Vec3(0, 1, 0);
  OverlayMesh mesh;
  const std::vector<OverlayVertex>& vertices = mesh.bones(*skeleton, world, {0, 0, 5});
  Aabb box;
  int faces = 0;
  for (const OverlayVertex& v : vertices) {
    box.extend(v.position.cast<double>());
    faces += v.normal[3] == 0;
    if (v.normal[3] != 0) continue;
    // Faces look outward: away from a point on the axis.
    const Vec3f outward = v.position - Vec3f(0, 0.2f, 0);
    EXPECT_GT(outward.dot(Vec3f(v.normal[0], v.normal[1], v.normal[2])), 0.0f);
  }
  EXPECT_EQ(faces, 8 * 3) << "a bone without length is omitted";
  EXPECT_NEAR(box.min.y(), 0.0, 1e-6);
  EXPECT_NEAR(box.max.y(), 1.0, 1e-6);
  EXPECT_LT(box.max.x(), 0.05);
}

/// Vertex positions of the prop as computed by the vertex shader.
TriMesh placed(const PropMesh& mesh, const PropInstance& instance) {
  TriMesh result;
  for (const PropMesh::Vertex& v : mesh.vertices) {
    const Vec3f p = v.corner.cwiseProduct(instance.extents) + v.normal * instance.bevel;
    result.vertices.push_back(
        (instance.x * p.x() + instance.y * p.y() + instance.z * p.z() + instance.origin).cast<double>());
  }
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    result.triangles.push_back({static_cast<VertexIndex>(mesh.indices[i]),
                                static_cast<VertexIndex>(mesh.indices[i + 1]),
                                static_cast<VertexIndex>(mesh.indices[i + 2])});
  }
  return result;
}

TEST(PropMesh, BoxHasItsExtentsAndNearlyItsVolume) {
  std::vector<Prop> props(2);
  props[0].halfExtents = {0.2, 0.3, 0.4};
  props[0].worldFromProp.translation() = Vec3(1, 2, 3);
  props[1].halfExtents.x() = std::numeric_limits<double>::quiet_NaN();
  std::vector<PropInstance> instances;
  makePropInstances(props, PropShape::kBox, instances);
  ASSERT_EQ(instances.size(), 1u);
  const TriMesh mesh = placed(makePropMesh(PropShape::kBox), instances[0]);
  const Aabb box = boundsOf(mesh.vertices);
  EXPECT_LT((box.min - Vec3(0.8, 1.7, 2.6)).norm(), 1e-5);
  EXPECT_LT((box.max - Vec3(1.2, 2.3, 3.4)).norm(), 1e-5);
  const double volume = signedVolume(mesh.vertices, mesh.triangles);
  EXPECT_LT(volume, 8 * 0.2 * 0.3 * 0.4);
  EXPECT_GT(volume, 0.97 * 8 * 0.2 * 0.3 * 0.4);
}

TEST(PropMesh, SphereHasItsRadiusAndNearlyItsVolume) {
  std::vector<Prop> props(1);
  props[0].shape = PropShape::kSphere;
  props[0].halfExtents = {0.25, 9, 9};
  std::vector<PropInstance> instances;
  makePropInstances(props, PropShape::kBox, instances);
  EXPECT_TRUE(instances.empty());
  makePropInstances(props, PropShape::kSphere, instances);
  ASSERT_EQ(instances.size(), 1u);
  const TriMesh mesh = placed(makePropMesh(PropShape::kSphere), instances[0]);
  for (const Vec3& v : mesh.vertices) EXPECT_NEAR(v.norm(), 0.25, 1e-6);
  const double ball = 4.0 / 3.0 * EIGEN_PI * std::pow(0.25, 3);
  EXPECT_NEAR(signedVolume(mesh.vertices, mesh.triangles), ball, 0.04 * ball);
}

TEST(PropMesh, CapsulesAndCylindersHaveTheirExtentsAndNearlyTheirVolumes) {
  constexpr double kRadius = 0.2, kHalf = 0.5;
  constexpr double kDisc = EIGEN_PI * kRadius * kRadius;
  for (const PropShape shape : {PropShape::kCapsule, PropShape::kCylinder}) {
    std::vector<Prop> props(1);
    props[0].shape = shape;
    props[0].halfExtents = {kRadius, kHalf, 9};
    std::vector<PropInstance> instances;
    makePropInstances(props, shape, instances);
    ASSERT_EQ(instances.size(), 1u);
    const TriMesh mesh = placed(makePropMesh(shape), instances[0]);
    const Aabb box = boundsOf(mesh.vertices);
    EXPECT_LT((box.max - Vec3(kRadius, kHalf, kRadius)).norm(), 1e-5);
    EXPECT_LT((box.min + Vec3(kRadius, kHalf, kRadius)).norm(), 1e-5);
    const double truth = shape == PropShape::kCylinder ? kDisc * 2.0 * kHalf
                                                       : kDisc * 2.0 * (kHalf - kRadius) + 4.0 / 3.0 * kDisc * kRadius;
    EXPECT_NEAR(signedVolume(mesh.vertices, mesh.triangles), truth, 0.04 * truth);
  }
}

}  // namespace
}  // namespace lorica
