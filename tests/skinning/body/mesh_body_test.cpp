#include "skinning/body/mesh_body.h"

#include "tests/support/damaged_meshes.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica::test {
namespace {

/// A sphere of radius 1 whose top is missing.
TriMesh bowl() {
  TriMesh mesh = makeSphere(1.0, 48, 64);
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return mesh.vertices[t[0]].y() > 0.8; });
  return mesh;
}

TEST(MeshBody, IsClosedAndHasTheVolumeOfWhatIsBelowTheHole) {
  const TriMesh mesh = bowl();
  const MeshBody body = valueOf(makeMeshBody(mesh));
  EXPECT_TRUE(checkClosedTwoManifold(body.mesh));
  const double ball = 4.0 / 3.0 * std::numbers::pi;
  const double cap = std::numbers::pi * 0.04 * (3.0 - 0.2) / 3.0;  // of height 0.2
  const double volume = signedVolume(body.mesh.vertices, body.mesh.triangles);
  EXPECT_GT(volume, 0.97 * (ball - cap));
  EXPECT_LT(volume, ball);
  EXPECT_GT(body.resolution, 0.0);
  EXPECT_LE(body.distances.meanToOriginal, body.resolution);
  EXPECT_LE(body.distances.farthestOutside, body.resolution);
}

TEST(MeshBody, EndsWithTheOriginalVertices) {
  TriMesh mesh = bowl();
  mesh.vertices.emplace_back(1e6, 0, 0);  // that no triangle uses
  const MeshBody body = valueOf(makeMeshBody(mesh));
  ASSERT_EQ(body.mesh.vertices.size(), mesh.vertices.size() + static_cast<std::size_t>(body.firstOriginal));
  EXPECT_TRUE(std::equal(mesh.vertices.begin(), mesh.vertices.end(), body.mesh.vertices.begin() + body.firstOriginal));
  for (const Triangle& t : body.mesh.triangles) {
    for (const VertexIndex v : t) EXPECT_LT(v, body.firstOriginal);
  }
}

TEST(MeshBody, DoesNotDependOnTheUnit) {
  const MeshBody one = makeMeshBody(bowl()).value();
  for (const double scale : {1e-6, 1e-3, 1e3, 1e9}) {
    TriMesh mesh = bowl();
    for (Vec3& p : mesh.vertices) p = scale * p + scale * Vec3(0.3, 0.2, 0.1);
    const MeshBody other = valueOf(makeMeshBody(mesh));
    EXPECT_EQ(other.mesh.triangles, one.mesh.triangles) << scale;
    EXPECT_NEAR(other.resolution / scale, one.resolution, 1e-9);
    EXPECT_NEAR(other.distances.meanToOriginal / scale, one.distances.meanToOriginal, 1e-9);
    EXPECT_NEAR(other.distances.farthestOutside / scale, one.distances.farthestOutside, 1e-9);
  }
}

TEST(MeshBody, ResolutionIsInTheMeshsUnit) {
  TriMesh mesh = bowl();
  for (Vec3& p : mesh.vertices) p *= 100.0;
  BodySettings settings;
  settings.resolution = 8.0;
  EXPECT_DOUBLE_EQ(makeMeshBody(mesh, settings).value().resolution, 8.0);
}

TEST(MeshBody, AClosedMeshIsRebuiltToo) {
  const MeshBody body = valueOf(makeMeshBody(makeLShape()));
  EXPECT_GT(body.firstOriginal, 12);
  EXPECT_NEAR(signedVolume(body.mesh.vertices, body.mesh.triangles), 3.0, 0.1);
}

TEST(MeshBody, EveryDamagedTorusGetsOne) {
  const TriMesh torus = makeTorus(1.0, 0.4, 32, 20);
  const double volume = signedVolume(torus.vertices, torus.triangles);
  for (const DamagedMesh& damaged : damagedMeshes(torus)) {
    const Result<MeshBody> body = makeMeshBody(damaged.mesh);
    ASSERT_TRUE(body) << damaged.damage << ": " << body.error().message;
    EXPECT_TRUE(checkClosedTwoManifold(body->mesh)) << damaged.damage;
    const double made = signedVolume(body->mesh.vertices, body->mesh.triangles);
    if (damaged.damage == "a fifth cut off") continue;
    EXPECT_NEAR(made, volume, 0.05 * volume) << damaged.damage;
  }
}

TEST(MeshBody, WithoutSizeThereIsNone) {
  EXPECT_FALSE(makeMeshBody({}));
  EXPECT_FALSE(makeMeshBody({{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}}}));
  EXPECT_FALSE(makeMeshBody({{{0, 0, 0}, {1e300, 0, 0}, {0, 1e308, -1e308}}, {{0, 1, 2}}}));
}

TEST(MeshBody, AFlatMeshIsRefusedInASentence) {
  // In any plane.
  for (const Vec3& normal : {Vec3(0.0, 0.0, 1.0), Vec3(1.0, 2.0, 3.0)}) {
    TriMesh quad{{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
    for (Vec3& p : quad.vertices) p = rotationBetween(Vec3(Vec3::UnitZ()), normal) * p;
    const Result<MeshBody> body = makeMeshBody(quad);
    ASSERT_FALSE(body);
    EXPECT_EQ(body.error().message, "it is exactly flat and has no volume to cut, give it a thickness");
  }
}

TEST(MeshBody, OfTooManyLayersIsRefusedInASentence) {
  // Every triangle is near every test point: 1,000 boxes look at 300,000,000, and 3,000 took minutes.
  for (const int boxes : {10, 1000}) {
    TriMesh nested;
    for (int i = 0; i < boxes; ++i) {
      const TriMesh box = makeBox(Vec3::Constant(-1.0 - 1e-3 * i), Vec3::Constant(1.0 + 1e-3 * i));
      const VertexIndex first = countOf(nested.vertices);
      nested.vertices.insert(nested.vertices.end(), box.vertices.begin(), box.vertices.end());
      for (const Triangle& t : box.triangles) {
        nested.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      }
    }
    const Result<MeshBody> body = makeMeshBody(nested);
    ASSERT_EQ(body.ok(), boxes == 10);
    if (boxes == 1000) {
      EXPECT_NE(body.error().message.find("in too many layers"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace lorica::test
