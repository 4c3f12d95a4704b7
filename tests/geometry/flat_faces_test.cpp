#include "geometry/flat_faces.h"

#include "geometry/counts.h"
#include "geometry/random_numbers.h"
#include "geometry/triangle_tree.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <vector>

namespace lorica::test {
namespace {

std::size_t usedCount(const TriMesh& mesh) {
  const std::vector<bool> used = usedVertices(mesh.vertices.size(), mesh.triangles);
  return std::count(used.begin(), used.end(), true);
}

TriMesh merged(const TriMesh& mesh) {
  return {mesh.vertices, mergeFlatFaces(mesh).triangles};
}

/// The mesh turned any way, as a file with single precision has it.
TriMesh turnedAndRounded(TriMesh mesh, RandomNumbers& random) {
  const auto number = [&] { return random.between(-1.0, 1.0); };
  const Quat turn = Quat(number(), number(), number(), number()).normalized();
  return moved(std::move(mesh), [&](const Vec3& p) { return Vec3((turn * p).cast<float>().cast<double>()); });
}

void expectSameSurface(const TriMesh& mesh, const TriMesh& given) {
  EXPECT_TRUE(checkClosedTwoManifold(mesh).ok());
  EXPECT_NEAR(signedVolume(mesh.vertices, mesh.triangles), signedVolume(given.vertices, given.triangles),
              1e-5 * signedVolume(given.vertices, given.triangles));
  EXPECT_NEAR(surfaceArea(mesh.vertices, mesh.triangles), surfaceArea(given.vertices, given.triangles),
              1e-5 * surfaceArea(given.vertices, given.triangles));
}

TEST(FlatFaces, HoweverTheyAreDividedHaveTheirCornersOnly) {
  RandomNumbers random(72);
  const TriMesh box = makeBox(Vec3(-1.0, 0.0, 2.0), Vec3(0.5, 3.0, 2.5));
  const TriMesh shape = makeLShape();
  for (int times = 0; times < 4; ++times) {
    SCOPED_TRACE(times);
    const TriMesh givenBox = turnedAndRounded(divided(box, times), random);
    expectSameSurface(merged(givenBox), givenBox);
    EXPECT_EQ(merged(givenBox).triangles.size(), 12u);
    EXPECT_EQ(usedCount(merged(givenBox)), 8u);
    // Two faces with six corners and six with four: n - 2 triangles each.
    const TriMesh givenShape = turnedAndRounded(divided(shape, times), random);
    expectSameSurface(merged(givenShape), givenShape);
    EXPECT_EQ(merged(givenShape).triangles.size(), 2u * 4u + 6u * 2u);
    EXPECT_EQ(usedCount(merged(givenShape)), 12u);
  }
}

int below(int count, RandomNumbers& random) {
  return static_cast<int>(random.between(0.0, count));
}

TEST(FlatFaces, OfRandomCubesKeepTheirSurface) {
  RandomNumbers random(73);
  for (int run = 0; run < 20; ++run) {
    SCOPED_TRACE(run);
    std::set<Voxel> voxels = {{2, 2, 2}};
    for (int step = 0; step < 30; ++step) {
      Voxel next = *std::next(voxels.begin(), below(countOf(voxels), random));
      next[below(3, random)] += below(2, random) == 0 ? 1 : -1;
      voxels.insert(next);
    }
    const TriMesh surface = makeVoxelSurface(voxels);
    if (!checkClosedTwoManifold(surface)) continue;  // cubes touch along an edge
    const TriMesh given = turnedAndRounded(surface, random);
    expectSameSurface(merged(given), given);
    EXPECT_LT(merged(given).triangles.size(), given.triangles.size());
    EXPECT_EQ(merged(given).triangles.size(), merged(divided(given)).triangles.size());
  }
}

TEST(FlatFaces, ThatBendAreLeft) {
  const TriMesh sphere = makeSphere(1.0, 12, 24);
  EXPECT_EQ(merged(sphere).triangles.size(), sphere.triangles.size());
  EXPECT_EQ(merged(divided(sphere)).triangles.size(), sphere.triangles.size());
}

/// Each vertex of a wheel with very many spokes is almost between its neighbors: what goes stays near what is left, for
/// distances add up.
TEST(FlatFaces, ThatBendALittleStayWhereTheyWere) {
  constexpr int kSpokes = 12000;
  TriMesh wheel;
  for (const double y : {0.0, 0.2}) {
    for (int i = 0; i < kSpokes; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kSpokes;
      wheel.vertices.emplace_back(std::sin(angle), y, std::cos(angle));
    }
  }
  for (int i = 0; i < kSpokes; ++i) {
    const int j = (i + 1) % kSpokes;
    wheel.triangles.push_back({i, j, kSpokes + j});
    wheel.triangles.push_back({i, kSpokes + j, kSpokes + i});
    if (i < 1 || j < 1) continue;
    wheel.triangles.push_back({0, j, i});
    wheel.triangles.push_back({kSpokes, kSpokes + i, kSpokes + j});
  }
  ASSERT_TRUE(checkClosedTwoManifold(wheel).ok());
  const TriMesh left = merged(wheel);
  EXPECT_TRUE(checkClosedTwoManifold(left).ok());
  EXPECT_LT(left.triangles.size(), wheel.triangles.size() / 2);
  const TriangleTree tree(left.vertices, left.triangles);
  const double limit = 3e-6 * boundsOf(wheel.vertices).diagonal();
  double farthest = 0.0;
  for (const Vec3& p : wheel.vertices) farthest = std::max(farthest, tree.distance(p));
  EXPECT_LT(farthest, limit);
}

TEST(FlatFaces, OfOpenSurfacesKeepTheirBorder) {
  TriMesh sheet;
  for (int z = 0; z <= 8; ++z) {
    for (int x = 0; x <= 8; ++x) sheet.vertices.emplace_back(x, 0.0, z);
  }
  for (int z = 0; z < 8; ++z) {
    for (int x = 0; x < 8; ++x) {
      if (x == 3 && z == 4) continue;  // a hole
      const int a = 9 * z + x;
      sheet.triangles.push_back({a, a + 9, a + 1});
      sheet.triangles.push_back({a + 1, a + 9, a + 10});
    }
  }
  const TriMesh left = merged(sheet);
  EXPECT_EQ(left.triangles.size(), 8u);  // between two squares
  EXPECT_EQ(usedCount(left), 8u);
  EXPECT_NEAR(surfaceArea(left.vertices, left.triangles), 63.0, 1e-12);
}

TEST(FlatFaces, ThatAreNoSurfaceAreReturned) {
  TriMesh mesh = makeBox(Vec3::Zero(), Vec3::Ones());
  mesh.vertices[3].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(mergeFlatFaces(mesh).triangles, mesh.triangles);
  mesh = makeBox(Vec3::Zero(), Vec3::Ones());
  mesh.triangles[2][1] = 8;
  EXPECT_EQ(mergeFlatFaces(mesh).triangles, mesh.triangles);
  EXPECT_TRUE(mergeFlatFaces({}).triangles.empty());
  // Three sheets on one edge: none has a neighbor there.
  mesh = {{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {1.0, -1.0, 0.0}, {0.0, 0.0, 1.0}},
          {{0, 1, 2}, {0, 1, 4}, {0, 3, 1}}};
  EXPECT_EQ(mergeFlatFaces(mesh).triangles, mesh.triangles);
}

}  // namespace
}  // namespace lorica::test
