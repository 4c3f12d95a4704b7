#include "geometry/tri_mesh.h"

#include "geometry/counts.h"
#include "geometry/mesh_files.h"
#include "geometry/random_numbers.h"
#include "geometry/triangle_tree.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

namespace lorica {
namespace {

double volumeOf(const TriMesh& mesh) {
  return signedVolume(mesh.vertices, mesh.triangles);
}
double areaOf(const TriMesh& mesh) {
  return surfaceArea(mesh.vertices, mesh.triangles);
}

std::string whyRefused(const TriMesh& mesh) {
  const auto checked = checkClosedTwoManifold(mesh);
  if (checked.ok()) return "";
  EXPECT_EQ(checked.error().code, ErrorCode::kBadMesh);
  return checked.error().message;
}

TEST(SignedVolume, ClosedForms) {
  EXPECT_DOUBLE_EQ(volumeOf(test::makeTetrahedron()), 1.0 / 6.0);
  EXPECT_DOUBLE_EQ(volumeOf(test::makeBox({-1, -2, -3}, {2, 2, 2})), 3.0 * 4.0 * 5.0);
  EXPECT_DOUBLE_EQ(volumeOf(test::makeLShape()), 3.0);
  EXPECT_EQ(signedVolume({}, {}), 0.0);
}

TEST(SignedVolume, SphereAndTorusConvergeWithTheSquareOfTheStep) {
  const double sphere = 4.0 / 3.0 * std::numbers::pi * 8.0;
  const double torus = 2.0 * std::numbers::pi * std::numbers::pi * 3.0 * 0.25;
  double sphereError = sphere - volumeOf(test::makeSphere(2.0, 16, 32));
  double torusError = torus - volumeOf(test::makeTorus(3.0, 0.5, 32, 16));
  EXPECT_LT(sphereError, 0.03 * sphere);
  EXPECT_LT(torusError, 0.05 * torus);
  for (int n = 32; n <= 128; n *= 2) {
    const double nextSphere = sphere - volumeOf(test::makeSphere(2.0, n, 2 * n));
    const double nextTorus = torus - volumeOf(test::makeTorus(3.0, 0.5, 2 * n, n));
    EXPECT_NEAR(sphereError / nextSphere, 4.0, 0.1);
    EXPECT_NEAR(torusError / nextTorus, 4.0, 0.1);
    sphereError = nextSphere;
    torusError = nextTorus;
  }
}

TEST(SurfaceArea, ClosedForms) {
  EXPECT_DOUBLE_EQ(areaOf(test::makeBox({0, 0, 0}, {1, 2, 3})), 22.0);
  EXPECT_DOUBLE_EQ(areaOf(test::makeTetrahedron()), 1.5 + std::sqrt(3.0) / 2.0);
  EXPECT_NEAR(areaOf(test::makeSphere(1.0, 200, 400)), 4.0 * std::numbers::pi, 1e-3);
}

TEST(SignedVolume, RigidMotionScaleAndDistanceFromTheOriginDoNotMatter) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const TriMesh torus = test::makeTorus(1.0, 0.3, 24, 12);
  for (int i = 0; i < 20; ++i) {
    const Quat rotation = Quat{normal(random), normal(random), normal(random), normal(random)}.normalized();
    const double scale = std::exp(normal(random));
    const Vec3 shift = 1e6 * Vec3{normal(random), normal(random), normal(random)};
    TriMesh moved = torus;
    for (Vec3& p : moved.vertices) p = scale * (rotation * p) + shift;
    // A position at 1e6 has a rounding error of 1e-10.
    EXPECT_NEAR(volumeOf(moved) / (scale * scale * scale * volumeOf(torus)), 1.0, 1e-8);
    EXPECT_NEAR(areaOf(moved) / (scale * scale * areaOf(torus)), 1.0, 1e-8);
    for (Triangle& t : moved.triangles) std::swap(t[0], t[1]);
    EXPECT_LT(volumeOf(moved), 0.0);
  }
}

TEST(ConnectedComponents, CountedInOrderOfFirstAppearance) {
  const TriMesh a = test::makeTetrahedron();
  const TriMesh b = test::makeBox({5, 0, 0}, {6, 1, 1});
  TriMesh both = test::joined(a, b);
  Components components = connectedComponents(both.vertices.size(), both.triangles);
  EXPECT_EQ(components.count, 2);
  ASSERT_EQ(components.componentOfTriangle.size(), 16u);
  for (std::size_t k = 0; k < 16; ++k) EXPECT_EQ(components.componentOfTriangle[k], k < 4 ? 0 : 1);

  std::reverse(both.triangles.begin(), both.triangles.end());
  components = connectedComponents(both.vertices.size(), both.triangles);
  EXPECT_EQ(components.componentOfTriangle.front(), 0);
  EXPECT_EQ(components.componentOfTriangle.back(), 1);
  EXPECT_EQ(connectedComponents(10, {}).count, 0);
}

TEST(CheckClosedTwoManifold, AcceptsClosedMeshes) {
  EXPECT_EQ(whyRefused(test::makeTetrahedron()), "");
  EXPECT_EQ(whyRefused(test::makeLShape()), "");
  EXPECT_EQ(whyRefused(test::makeTorus(2, 0.5, 12, 8)), "");
  EXPECT_EQ(whyRefused(test::joined(test::makeTetrahedron(), test::makeBox({5, 5, 5}, {6, 6, 6}))), "");
}

TEST(CheckClosedTwoManifold, AcceptsACavityAndAVertexWhereTwoFansMeet) {
  const TriMesh hollow = test::makeHollowBox();
  EXPECT_EQ(whyRefused(hollow), "");
  EXPECT_DOUBLE_EQ(volumeOf(hollow), 26.0);

  TriMesh bowTie = test::joined(test::makeBox({0, 0, 0}, {1, 1, 1}), test::makeBox({1, 1, 1}, {2, 2, 2}));
  EXPECT_EQ(weldEqualVertices(bowTie), 1u);
  EXPECT_EQ(whyRefused(bowTie), "");
  EXPECT_EQ(connectedComponents(bowTie.vertices.size(), bowTie.triangles).count, 1);
}

TEST(CheckClosedTwoManifold, NamesWhatIsWrong) {
  const std::vector<std::pair<void (*)(TriMesh&), const char*>> rows = {
      {[](TriMesh& mesh) { mesh = {}; }, "the mesh has 0 vertices and no triangle"},
      {[](TriMesh& mesh) { mesh.triangles[2][1] = 4, mesh.triangles[3][0] = -1; },
       "triangle 2: vertex index 4 is out of range, expected 0 to 3 (4 vertices); 2 such indices in all"},
      {[](TriMesh& mesh) { mesh.vertices[3].y() = std::numeric_limits<double>::infinity(); },
       "vertex 3: position (0, inf, 1) is not finite; 1 such vertex in all"},
      {[](TriMesh& mesh) {
         mesh.triangles[1] = {0, 3, 3};
       },
       "triangle 1: vertices 0, 3, 3, expected three different ones; 1 such triangle in all"},
      {[](TriMesh& mesh) { mesh.triangles.pop_back(); },
       "edge 1-2 belongs to one triangle (0), expected two; 3 such edges: the mesh is open"},
      {[](TriMesh& mesh) { std::swap(mesh.triangles[3][0], mesh.triangles[3][1]); },
       "edge 1-2: triangles 0 and 3 run along it in the same direction, expected opposite; 3 such edges: the triangles "
       "are not consistently oriented"},
      {[](TriMesh& mesh) { mesh = test::insideOut(mesh); },
       "the mesh is inside out: its signed volume is -0.166667, expected above 0; reverse all triangles"},
      {[](TriMesh& mesh) { mesh.vertices[3].z() = 0.0; },
       "the mesh is flat: its volume is 0 with a diagonal of 1.41421"},
      {[](TriMesh& mesh) { mesh = test::moved(mesh, [](const Vec3& p) -> Vec3 { return 1e150 * p; }); },
       "the mesh's diagonal is 1.73205e+150: too large to measure a volume"}};
  for (const auto& [damage, message] : rows) {
    TriMesh mesh = test::makeTetrahedron();  // {0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}
    damage(mesh);
    EXPECT_EQ(whyRefused(mesh), message);
  }
}

TEST(CheckClosedTwoManifold, NamesAnEdgeOfFourTriangles) {
  TriMesh boxes = test::joined(test::makeBox({0, 0, 0}, {1, 1, 1}), test::makeBox({1, 1, 0}, {2, 2, 1}));
  EXPECT_EQ(weldEqualVertices(boxes), 2u);  // they share the edge at x = y = 1
  EXPECT_EQ(
      whyRefused(boxes),
      "edge 3-7 belongs to 4 triangles (7, 10, 17, 20), expected two; 1 such edge: the mesh is not a two-manifold; "
      "repairClosedMesh() can separate the triangles");
}

TEST(CheckClosedTwoManifold, SaysWhereWeldingWouldHelp) {
  TriMesh split;
  for (const Triangle& t : test::makeTetrahedron().triangles) {
    const auto first = countOf(split.vertices);
    for (const VertexIndex v : t) split.vertices.push_back(test::makeTetrahedron().vertices[v]);
    split.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(whyRefused(split),
            "edge 0-1 belongs to one triangle (0), expected two; 12 such edges: the mesh is open; welding 8 "
            "vertices at positions of others would leave 0 open edges");
  EXPECT_EQ(weldEqualVertices(split), 8u);
  EXPECT_EQ(whyRefused(split), "");
}

TEST(WeldEqualVertices, KeepsOrderTreatsMinusZeroAsZeroAndDropsCollapsedTriangles) {
  TriMesh mesh{{{1, 0, 0}, {0.0, 0, 0}, {2, 0, 0}, {-0.0, 0, 0}, {3, 1, 0}}, {{0, 1, 2}, {1, 3, 4}, {3, 4, 2}}};
  EXPECT_EQ(weldEqualVertices(mesh), 1u);
  EXPECT_EQ(mesh.vertices, (std::vector<Vec3>{{1, 0, 0}, {0, 0, 0}, {2, 0, 0}, {3, 1, 0}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}}));
  EXPECT_EQ(weldEqualVertices(mesh), 0u);
}

/// The same check by the simplest means.
bool closedBySlowCount(const TriMesh& mesh) {
  std::map<std::pair<int, int>, int> directed;
  for (const Triangle& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) ++directed[{t[i], t[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : directed) {
    const auto opposite = directed.find({edge.second, edge.first});
    if (count != 1 || opposite == directed.end() || opposite->second != 1) return false;
  }
  return true;
}

TEST(CheckClosedTwoManifold, AgreesWithASlowCountOnDamagedMeshes) {
  std::mt19937 random(11);
  const TriMesh whole = test::makeTorus(2.0, 0.7, 9, 7);
  int closed = 0;
  for (int i = 0; i < 300; ++i) {
    TriMesh mesh = whole;
    const auto pick = [&] { return random() % mesh.triangles.size(); };
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
    if (i % 5 == 1) mesh.triangles.erase(mesh.triangles.begin() + static_cast<int>(pick()));
    if (i % 5 == 2) mesh.triangles.push_back(mesh.triangles[pick()]);
    if (i % 5 == 3) std::swap(mesh.triangles[pick()][0], mesh.triangles[0][1]);
    if (i % 5 == 4) std::reverse(mesh.triangles[0].begin(), mesh.triangles[0].end());
    const bool expected = closedBySlowCount(mesh);
    const std::string why = whyRefused(mesh);
    EXPECT_EQ(why.empty(), expected) << why;
    closed += expected ? 1 : 0;
    std::size_t open = 0;
    std::map<std::pair<int, int>, int> sides;
    for (const Triangle& t : mesh.triangles) {
      for (int k = 0; k < 3; ++k) ++sides[std::minmax(int{t[k]}, int{t[(k + 1) % 3]})];
    }
    for (const auto& side : sides) open += side.second == 1 ? 1 : 0;
    EXPECT_EQ(openEdgeCount(mesh), open);
  }
  EXPECT_GE(closed, 60);
  EXPECT_LE(closed, 240);
}

TEST(CheckClosedTwoManifold, VhacdMeshesAreClosedButTheDinosaur) {
  LORICA_REQUIRE_DATASET(folder, "vhacd");
  int meshes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".off") continue;
    const auto mesh = test::valueOf(readMesh(entry.path()));
    ++meshes;
    const std::string why = whyRefused(mesh);
    if (entry.path().stem() != "Dinosaur") {
      EXPECT_EQ(why, "") << entry.path();
    } else {
      EXPECT_NE(why.find("belongs to 4 triangles"), std::string::npos) << why;
      EXPECT_NE(why.find("2 such edges: the mesh is not a two-manifold"), std::string::npos) << why;
    }
    if (entry.path().stem() == "Octopus") {
      EXPECT_EQ(connectedComponents(mesh.vertices.size(), mesh.triangles).count, 4);
    }
    if (entry.path().stem() == "Bunny") {
      EXPECT_EQ(mesh.vertices.size(), 34834u);
      EXPECT_EQ(mesh.triangles.size(), 69664u);
      EXPECT_EQ(mesh.vertices[0], Vec3(-0.092314, -0.132364, -0.018222));
      EXPECT_EQ(mesh.triangles.back(), (Triangle{31716, 32578, 32963}));
    }
  }
  EXPECT_EQ(meshes, 16);
}

Vec3 somewhere(RandomNumbers& random, double reach) {
  const double x = random.between(-reach, reach);
  const double y = random.between(-reach, reach);
  return {x, y, random.between(-reach, reach)};
}

/// Random triangles, some of them slivers, segments and points.
TriMesh soup(int count, RandomNumbers& random) {
  TriMesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3 a = somewhere(random, 1.0);
    const Vec3 b = a + somewhere(random, 0.2);
    Vec3 c = a + somewhere(random, 0.2);
    if (i % 10 == 7) c = 0.5 * (a + b);
    if (i % 10 == 8) c = b;
    const auto v = countOf(mesh.vertices);
    mesh.vertices.insert(mesh.vertices.end(), {a, b, i % 10 == 9 ? a : c});
    mesh.triangles.push_back({v, v + 1, v + 2});
  }
  return mesh;
}

std::array<Vec3, 3> cornersOf(const TriMesh& mesh, std::size_t k) {
  const Triangle& t = mesh.triangles[k];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

/// The nearest point of a triangle by sampling many points.
double distanceBySampling(const Vec3& p, const std::array<Vec3, 3>& t) {
  constexpr int kSteps = 120;
  double min = 1e9;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      const double u = static_cast<double>(i) / kSteps, v = static_cast<double>(j) / kSteps;
      min = std::min(min, (t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]) - p).norm());
    }
  }
  return min;
}

TEST(TriangleTree, TheNearestPointOfATriangleIsIt) {
  RandomNumbers random(3);
  const TriMesh mesh = soup(40, random);
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const std::array<Vec3, 3> t = cornersOf(mesh, k);
    const Vec3 p = somewhere(random, 1.0);
    const auto [distanceSq, shares] = nearestOnTriangle(p, t);
    EXPECT_NEAR(shares.sum(), 1.0, 1e-12);
    EXPECT_GE(shares.minCoeff(), 0.0);
    EXPECT_NEAR((shares[0] * t[0] + shares[1] * t[1] + shares[2] * t[2] - p).norm(), std::sqrt(distanceSq), 1e-9);
    const double sampled = distanceBySampling(p, t);
    EXPECT_LE(std::sqrt(distanceSq), sampled + 1e-12);
    EXPECT_NEAR(std::sqrt(distanceSq), sampled, 4e-3);
  }
}

TEST(TriangleTree, FindsWhatASearchOfAllFinds) {
  RandomNumbers random(4);
  for (const int count : {1, 4, 5, 300}) {
    const TriMesh mesh = soup(count, random);
    const TriangleTree tree(mesh.vertices, mesh.triangles);
    for (int i = 0; i < 200; ++i) {
      const Vec3 p = somewhere(random, 1.5);
      double min = 1e9, minEven = 1e9;
      std::set<std::int32_t> within;
      for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
        const double distance = std::sqrt(nearestOnTriangle(p, cornersOf(mesh, k)).first);
        min = std::min(min, distance);
        if (k % 2 == 0) minEven = std::min(minEven, distance);
        if (distance <= 0.3) within.insert(static_cast<std::int32_t>(k));
      }
      EXPECT_DOUBLE_EQ(tree.nearest(p).distance, min);
      const auto even =
          tree.nearest(p, std::numeric_limits<double>::infinity(), [](std::int32_t t) { return t % 2 == 0; });
      EXPECT_DOUBLE_EQ(even.distance, minEven);
      EXPECT_EQ(even.triangle % 2, 0);
      EXPECT_EQ(tree.nearest(p, 0.9 * min, [](std::int32_t) { return true; }).triangle, -1);
      std::set<std::int32_t> visited;
      tree.forEachWithin(p, 0.3, [&](std::int32_t t, double distance) {
        visited.insert(t);
        EXPECT_DOUBLE_EQ(distance, std::sqrt(nearestOnTriangle(p, cornersOf(mesh, static_cast<std::size_t>(t))).first));
      });
      EXPECT_EQ(visited, within);
    }
  }
}

TEST(TriangleTree, WindingNumbersAreThoseOfClosedForms) {
  RandomNumbers random(5);
  const TriMesh sphere = test::makeSphere(1.0, 40, 60);
  const TriangleTree whole(sphere.vertices, sphere.triangles);
  TriMesh half = sphere;
  std::erase_if(half.triangles, [&](const Triangle& t) {
    return (sphere.vertices[t[0]] + sphere.vertices[t[1]] + sphere.vertices[t[2]]).y() < 0.0;
  });
  const TriangleTree dome(half.vertices, half.triangles);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = somewhere(random, 2.0);
    if (std::abs(p.norm() - 1.0) > 0.02) {
      EXPECT_NEAR(whole.windingNumber(p), p.norm() < 1.0 ? 1.0 : 0.0, 0.05);
    }
    // From the dome's axis its missing disc is seen as a cone.
    const double y = random.between(-1.9, 0.9);
    const double cone = 0.5 * (1.0 - std::abs(y) / std::sqrt(1.0 + y * y));
    EXPECT_NEAR(dome.windingNumber(Vec3(0, y, 0)), y > 0.0 ? 1.0 - cone : cone, 0.05) << y;
  }
  EXPECT_NEAR(whole.windingNumber(Vec3(100, 0, 0)), 0.0, 1e-6);
}

}  // namespace
}  // namespace lorica
