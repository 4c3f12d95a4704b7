#include "geometry/small_faults.h"

#include "geometry/mesh_files.h"
#include "geometry/mesh_pieces.h"
#include "geometry/mesh_repair.h"
#include "tests/support/damaged_meshes.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

namespace lorica::test {
namespace {

double volumeOf(const TriMesh& mesh) {
  return signedVolume(mesh.vertices, mesh.triangles);
}

TriMesh cube(double size) {
  return makeBox(Vec3::Constant(-0.5 * size), Vec3::Constant(0.5 * size));
}

/// Repairs, and checks what must hold in every case.
FaultRepair repaired(const TriMesh& mesh) {
  FaultRepair repair = valueOf(repairSmallFaults(mesh));
  EXPECT_TRUE(checkClosedTwoManifold(repair.mesh));
  EXPECT_EQ(repair.changed(), !repair.summary().empty());
  EXPECT_TRUE(std::equal(mesh.vertices.begin(), mesh.vertices.end(), repair.mesh.vertices.begin()));
  if (repair.unitedPieces > 0) return repair;
  // Every vertex that was used is used, or known to be left out.
  std::vector<int> uses(mesh.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    for (const VertexIndex v : t) uses[v] = 1;
  }
  for (const Triangle& t : repair.mesh.triangles) {
    for (const VertexIndex v : t) {
      if (v < std::ssize(uses)) uses[v] = 0;
    }
  }
  for (const VertexIndex v : repair.leftOut) --uses[v];
  EXPECT_EQ(std::count(uses.begin(), uses.end(), 0), std::ssize(uses));
  return repair;
}

TEST(SmallFaults, ASoundMeshComesBackAsItWas) {
  for (const TriMesh& mesh : {makeTetrahedron(), makeTorus(1, 0.3, 8, 6), joined(cube(3), insideOut(cube(1))),
                              joined(makeLShape(), makeBox({5, 5, 5}, {6, 6, 6}))}) {
    const FaultRepair repair = repaired(mesh);
    EXPECT_FALSE(repair.changed()) << repair.summary();
    EXPECT_EQ(repair.mesh.triangles, mesh.triangles);
    EXPECT_TRUE(repair.leftOut.empty());
  }
}

TEST(SmallFaults, DamageOfACubeIsRepairedAndNamed) {
  const TriMesh whole = cube(1);
  TriMesh flipped = whole, repeated = whole, backToBack = whole, bothSides = whole, open = whole;
  std::swap(flipped.triangles[3][0], flipped.triangles[3][2]);
  const Triangle t = whole.triangles[5];
  repeated.triangles.push_back(t);
  backToBack.triangles.push_back({t[0], t[2], t[1]});
  for (const Triangle& back : insideOut(whole).triangles) bothSides.triangles.push_back(back);
  open.triangles.pop_back();
  for (const auto& [damaged, volume, summary] : {std::tuple{flipped, 1.0, "1 triangle turned"},
                                                 {insideOut(cube(2)), 8.0, "reversed, for it was inside out"},
                                                 {repeated, 1.0, "1 duplicate triangle removed"},
                                                 {backToBack, 1.0, "1 repeated triangle dropped"},
                                                 {bothSides, 1.0, ""},
                                                 {open, 1.0, "1 pinhole closed with 1 triangle"}}) {
    SCOPED_TRACE(summary);
    const FaultRepair repair = repaired(damaged);
    EXPECT_NEAR(volumeOf(repair.mesh), volume, 1e-15 * volume);
    EXPECT_TRUE(*summary == '\0' || repair.summary() == summary) << repair.summary();
  }
  for (const TriMesh& mesh : {repeated, backToBack}) EXPECT_EQ(repaired(mesh).mesh.triangles, whole.triangles);
}

TEST(SmallFaults, APinholeInAPlaneIsClosedExactly) {
  // The pole of a sphere with many segments, flattened: a polygon of 24 edges that is 4 % of the diagonal across.
  const int segments = 24;
  TriMesh mesh = makeSphere(1.0, 64, segments);
  const double volume = volumeOf(mesh);
  const auto pole =
      static_cast<VertexIndex>(std::max_element(mesh.vertices.begin(), mesh.vertices.end(),
                                                [](const Vec3& a, const Vec3& b) { return a.y() < b.y(); }) -
                               mesh.vertices.begin());
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return std::find(t.begin(), t.end(), pole) != t.end(); });
  const FaultRepair repair = repaired(mesh);
  EXPECT_EQ(repair.pinholes, 1u);
  EXPECT_EQ(repair.capTriangles, static_cast<std::size_t>(segments) - 2);
  // What is lost is the pyramid below the pole.
  const double angle = std::numbers::pi / 64;
  const double base = 0.5 * segments * std::sin(2.0 * std::numbers::pi / segments) * std::sin(angle) * std::sin(angle);
  EXPECT_NEAR(volumeOf(repair.mesh), volume - base * (1.0 - std::cos(angle)) / 3.0, 1e-12);
}

TEST(SmallFaults, ASlitIsClosedThoughItIsLong) {
  TriMesh mesh = makeSphere(1.0, 32, 32);
  const double volume = volumeOf(mesh);
  // Half of a meridian, taken apart by 1e-3 on one side.
  std::vector<VertexIndex> other(mesh.vertices.size(), -1);
  for (std::size_t v = 0; v < other.size(); ++v) {
    const Vec3 p = mesh.vertices[v];
    if (std::abs(p.z()) > 1e-9 || p.x() <= 0.0 || std::abs(p.y()) > 0.7) continue;
    other[v] = static_cast<VertexIndex>(mesh.vertices.size());
    mesh.vertices.push_back(p + Vec3(0, 0, 1e-3));
  }
  for (Triangle& t : mesh.triangles) {
    const Vec3 center = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
    for (VertexIndex& v : t) {
      if (center.z() > 0.0 && static_cast<std::size_t>(v) < other.size() && other[v] >= 0) v = other[v];
    }
  }
  const FaultRepair repair = repaired(mesh);
  EXPECT_EQ(repair.pinholes, 1u);
  EXPECT_GT(repair.capTriangles, 10u);
  EXPECT_NEAR(volumeOf(repair.mesh), volume, 2e-3);
}

TEST(SmallFaults, AFinGoesAndItsTipIsLeftOut) {
  for (const bool front : {false, true}) {
    TriMesh mesh = joined(cube(2), TriMesh{{Vec3::Zero()}, {}});
    const VertexIndex tip = 8;
    const Triangle top = *std::ranges::find_if(mesh.triangles, [&](const Triangle& t) {
      return std::ranges::all_of(t, [&](VertexIndex v) { return mesh.vertices[v].z() > 0.0; });
    });
    const Vec3 middle = 0.5 * (mesh.vertices[top[0]] + mesh.vertices[top[1]]);
    mesh.vertices[tip] = middle + 0.1 * Vec3::UnitZ();
    mesh.triangles.push_back(front ? Triangle{top[0], top[1], tip} : Triangle{top[1], top[0], tip});
    const FaultRepair repair = repaired(mesh);
    EXPECT_NEAR(volumeOf(repair.mesh), 8.0, 1e-12);
    EXPECT_EQ(repair.mesh.triangles.size(), 12u);
    EXPECT_EQ(repair.leftOut, std::vector<VertexIndex>{tip});
    // A large one is a sheet of its own.
    mesh.vertices[tip] = middle + Vec3::UnitZ();
    EXPECT_FALSE(repairSmallFaults(mesh));
  }
}

TEST(SmallFaults, OpenBoxesCardsAndLoneTrianglesAreTooMuch) {
  TriMesh box = cube(1);
  box.triangles.resize(10);
  const Result<FaultRepair> repair = repairSmallFaults(box);
  ASSERT_FALSE(repair);
  EXPECT_NE(repair.error().message.find("belongs to one triangle"), std::string::npos) << repair.error().message;
  const TriMesh card{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  EXPECT_FALSE(repairSmallFaults(card));
  EXPECT_FALSE(repairSmallFaults({card.vertices, {{0, 1, 2}}}));
  // A small card beside a large body, too.
  const TriMesh small = moved(card, [](const Vec3& p) -> Vec3 { return 0.1 * p + Vec3(3, 0, 0); });
  EXPECT_FALSE(repairSmallFaults(joined(makeSphere(2.0, 16, 16), small)));
}

TEST(SmallFaults, AOneSidedSurfaceIsTooMuch) {
  TriMesh strip;
  const int n = 12;
  for (int i = 0; i < n; ++i) {
    const double a = 2.0 * std::numbers::pi * i / n;
    const Vec3 out(std::cos(a), 0, std::sin(a));
    const Vec3 across = 0.3 * (std::cos(0.5 * a) * out + std::sin(0.5 * a) * Vec3::UnitY());
    strip.vertices.push_back(out + across);
    strip.vertices.push_back(out - across);
  }
  for (int i = 0; i < n; ++i) {
    const bool last = i == n - 1;
    const VertexIndex a = 2 * i, b = 2 * i + 1, c = last ? 1 : a + 2, d = last ? 0 : b + 2;
    strip.triangles.push_back({a, b, c});
    strip.triangles.push_back({b, d, c});
  }
  EXPECT_FALSE(repairSmallFaults(strip));
}

TEST(SmallFaults, TinyOpenPiecesAreDroppedAndLeftOut) {
  TriMesh speck{{{1, 1, 1}, {1.001, 1, 1}, {1, 1.001, 1}}, {{0, 1, 2}}};
  const FaultRepair repair = repaired(joined(cube(1), speck));
  EXPECT_EQ(repair.specks, 1u);
  EXPECT_EQ(repair.leftOut, (std::vector<VertexIndex>{8, 9, 10}));
}

TEST(SmallFaults, NestedCubes) {
  const TriMesh outer = cube(4), inner = cube(2), core = cube(1);
  const double cavity = 64.0 - 8.0;
  const TriMesh hollow = joined(outer, insideOut(inner));
  TriMesh flipped = hollow;
  std::swap(flipped.triangles[15][0], flipped.triangles[15][1]);
  TriMesh missing = flipped;
  missing.triangles.erase(missing.triangles.begin() + 20);
  for (const auto& [what, mesh, volume] :
       {std::tuple{"a cavity", hollow, cavity},
        {"a solid in a solid", joined(outer, inner), 64.0},
        {"all inside out", insideOut(hollow), cavity},
        {"the outer one inside out", joined(insideOut(outer), insideOut(inner)), cavity},
        {"the cavity first", joined(insideOut(inner), outer), cavity},
        {"a solid in the cavity", insideOut(joined(hollow, core)), cavity + 1.0},
        {"a triangle of the cavity flipped", flipped, cavity},
        {"and one missing", missing, cavity}}) {
    EXPECT_NEAR(volumeOf(repaired(mesh).mesh), volume, 1e-12) << what;
  }
}

/// Cubes in each other, all inside out: every second one becomes solid, up to 500,000 pairs of an inner and an outer
/// one.
TEST(SmallFaults, PiecesInEachOtherAreTurnedUpToALimit) {
  TriMesh nested;
  for (int count = 1; count <= 1001; ++count) {
    nested = joined(nested, insideOut(cube(0.01 * count)));
    if (count < 1000) continue;
    TriMesh turned = nested;
    EXPECT_EQ(turnPiecesOutward(turned).reversed, count == 1000 ? 500u : 0u);
  }
}

TEST(SmallFaults, APieceBesideOthersThatIsInsideOutIsReversed) {
  const FaultRepair repair = repaired(joined(cube(2), insideOut(makeBox({5, 0, 0}, {6, 1, 1}))));
  EXPECT_NEAR(volumeOf(repair.mesh), 9.0, 1e-14);
  EXPECT_EQ(repair.summary(), "1 inside-out piece reversed");
}

TEST(SmallFaults, SolidsThatTouchStayApartWhenSomethingElseIsRepaired) {
  // Two boxes with a common face, of whose walls both are there, and a flipped triangle elsewhere.
  TriMesh mesh = joined(makeBox({0, 0, 0}, {1, 1, 1}), makeBox({1, 0, 0}, {2, 1, 1}));
  (void)weldEqualVertices(mesh);
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const Triangle& t = mesh.triangles[k];
    const bool wall = std::all_of(t.begin(), t.end(), [&](VertexIndex v) { return mesh.vertices[v].x() == 1.0; });
    if (wall) continue;
    TriMesh damaged = mesh;
    std::swap(damaged.triangles[k][0], damaged.triangles[k][1]);
    EXPECT_NEAR(volumeOf(repaired(damaged).mesh), 2.0, 1e-14) << k;
  }
}

TEST(SmallFaults, TheOrderOfTrianglesAndVerticesDoesNotMatter) {
  for (const DamagedMesh& damaged : damagedMeshes(makeTorus(1.0, 0.4, 24, 16))) {
    const Result<FaultRepair> before = repairSmallFaults(damaged.mesh);
    std::mt19937 random(3);
    TriMesh mixed = damaged.mesh;
    std::vector<VertexIndex> place(mixed.vertices.size());
    std::iota(place.begin(), place.end(), 0);
    std::shuffle(place.begin(), place.end(), random);
    for (std::size_t v = 0; v < place.size(); ++v) mixed.vertices[place[v]] = damaged.mesh.vertices[v];
    for (Triangle& t : mixed.triangles) {
      for (VertexIndex& v : t) v = place[v];
      std::rotate(t.begin(), t.begin() + random() % 3, t.end());
    }
    std::shuffle(mixed.triangles.begin(), mixed.triangles.end(), random);
    const Result<FaultRepair> after = repairSmallFaults(mixed);
    ASSERT_EQ(before.ok(), after.ok()) << damaged.damage;
    if (!before) continue;
    EXPECT_NEAR(volumeOf(before->mesh), volumeOf(after->mesh), damaged.loss == Loss::kNone ? 1e-12 : 1e-5)
        << damaged.damage;
    EXPECT_EQ(before->pinholes, after->pinholes) << damaged.damage;
  }
}

TEST(SmallFaults, MotionAndScaleDoNotMatter) {
  for (const DamagedMesh& damaged : damagedMeshes(makeTorus(1.0, 0.4, 24, 16))) {
    const Result<FaultRepair> before = repairSmallFaults(damaged.mesh);
    for (const double scale : {1e-3, 1.0, 1e3}) {
      const Quat turn = Quat(0.3, 0.5, -0.7, 0.2).normalized();
      const Result<FaultRepair> after = repairSmallFaults(
          moved(damaged.mesh, [&](const Vec3& p) -> Vec3 { return scale * (turn * p + Vec3(3, -2, 5)); }));
      ASSERT_EQ(before.ok(), after.ok()) << damaged.damage << ", scale " << scale;
      if (!before) continue;
      EXPECT_EQ(before->summary(), after->summary()) << damaged.damage;
      EXPECT_NEAR(volumeOf(after->mesh) / (scale * scale * scale), volumeOf(before->mesh), 1e-6) << damaged.damage;
    }
  }
}

class SmallFaultsOfRealMeshes : public testing::TestWithParam<const char*> {};

TEST_P(SmallFaultsOfRealMeshes, NothingIsLostWhereNothingWasMissing) {
  LORICA_REQUIRE_DATASET(file, std::string("vhacd/") + GetParam());
  const TriMesh read = test::valueOf(readMesh(file));
  const MeshRepair sound = test::valueOf(repairClosedMesh(read));
  const double volume = volumeOf(sound.mesh);
  for (const DamagedMesh& damaged : damagedMeshes(sound.mesh)) {
    SCOPED_TRACE(damaged.damage);
    if (damaged.loss == Loss::kSurface) {
      const Result<FaultRepair> repair = repairSmallFaults(damaged.mesh);
      EXPECT_TRUE(!repair || volumeOf(repair->mesh) > 0.0);
      continue;
    }
    EXPECT_NEAR(volumeOf(repaired(damaged.mesh).mesh), volume, (damaged.loss == Loss::kNone ? 1e-9 : 1e-5) * volume);
  }
}

INSTANTIATE_TEST_SUITE_P(VHacd, SmallFaultsOfRealMeshes,
                         testing::Values("Block.off", "Cow.off", "Elk_Toy.off", "Genus.off", "Sledge.off", "Sword.off",
                                         "Table.off", "Torus.off"),
                         [](const auto& row) {
                           return std::string(row.param).substr(0, std::string(row.param).find('.'));
                         });

}  // namespace
}  // namespace lorica::test
