#include "acd/score.h"

#include "acd/volume_coverage.h"
#include "geometry/convex_hull.h"
#include "geometry/mesh_files.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <random>

namespace lorica {
namespace {

Score scoreOf(const TriMesh& mesh, const std::vector<TriMesh>& parts, const ScoreSettings& settings = {}) {
  const auto result = score(mesh, parts, settings);
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message);
  return result.ok() ? *result : Score{};
}

/// Tolerances for sampling errors and for rounding errors.
double allowance(const Score& s) {
  return 4.0 * s.score16StandardError + 1e-9;
}

const TriMesh kUnitCube = test::makeBox({0, 0, 0}, {1, 1, 1});

TEST(Score, CubeByItselfIsPerfect) {
  const Score s = scoreOf(kUnitCube, {kUnitCube});
  EXPECT_NEAR(s.score16, 1.0, 1e-12);
  EXPECT_NEAR(s.score16StandardError, 0.0, 1e-12);
  EXPECT_DOUBLE_EQ(s.score17, 1.0);
  EXPECT_NEAR(s.distance, 0.0, 1e-12);
  EXPECT_NEAR(s.uncoveredFraction, 0.0, 1e-12);
}

TEST(Score, OverlappingBoxesCountTwice) {
  // Halves that overlap by a fifth of the cube: volumes 0.6 + 0.6, nothing uncovered.
  const Score s = scoreOf(kUnitCube, {test::makeBox({0, 0, 0}, {0.6, 1, 1}), test::makeBox({0.4, 0, 0}, {1, 1, 1})});
  EXPECT_NEAR(s.score17, 1.0 / 1.2, 1e-12);
  EXPECT_NEAR(s.score16, 1.0 / 1.2, 1e-9);
  EXPECT_NEAR(s.uncoveredFraction, 0.0, 1e-12);
}

TEST(Score, ShiftedCubeInClosedForm) {
  // Covered 0.5 * 0.7 * 0.9; the rest of the mesh is below the fraction line.
  const double covered = 0.5 * 0.7 * 0.9;
  const Score s = scoreOf(kUnitCube, {test::makeBox({0.5, 0.3, 0.1}, {1.5, 1.3, 1.1})});
  EXPECT_GT(s.score16StandardError, 0.0);
  EXPECT_LT(s.score16StandardError, 1e-3);
  EXPECT_NEAR(s.score16, covered / (1.0 - covered + 1.0), allowance(s));
  EXPECT_NEAR(s.uncoveredFraction, 1.0 - covered, 8.0 * s.score16StandardError);
  EXPECT_DOUBLE_EQ(s.score17, 1.0);
}

TEST(Score, PartOutsideTheMeshCoversNothing) {
  const Score s = scoreOf(kUnitCube, {test::makeBox({2, 0, 0}, {3, 1, 1})});
  EXPECT_EQ(s.score16, 0.0);
  EXPECT_EQ(s.uncoveredFraction, 1.0);
  // From (x, y, z) on the cube to the face at x = 2 the distance is 2 - x: 1 and 2 on two faces, mean 1.5 on four.
  EXPECT_NEAR(s.distance, 1.5, 1e-3);
  EXPECT_NEAR(s.distancePercentDiagonal, 100.0 * s.distance / std::sqrt(3.0), 1e-12);
}

TEST(Score, DistanceIsToTheHullsSurfaceFromInsideToo) {
  // A hull 0.25 larger on all sides: the nearest face is the parallel one, 0.25 from every point of the cube.
  const Score s = scoreOf(kUnitCube, {test::makeBox({-0.25, -0.25, -0.25}, {1.25, 1.25, 1.25})});
  EXPECT_NEAR(s.distance, 0.25, 1e-12);
  EXPECT_NEAR(s.uncoveredFraction, 0.0, 1e-12);
}

TEST(Score, LShapeByItsHullAndByItsHalves) {
  // The hull of the L adds the triangle (2,1), (1,1), (1,2) of area 1/2: 3 / 3.5.
  const TriMesh l = test::makeLShape();
  Score s = scoreOf(l, {l});
  EXPECT_NEAR(s.score17, 3.0 / 3.5, 1e-12);
  EXPECT_NEAR(s.score16, 3.0 / 3.5, 1e-9);
  // Of its surface of 14 only the two inner unit squares are off the hull. A point on one is a = (1 - s) sqrt(1/2) from
  // the slanted face and b = min(z, 1 - z) from a cap, both uniform, up to A = sqrt(1/2) and B = 1/2. The mean of
  // min(a, b) is the integral over t in 0 to B of (1 - t/A) (1 - t/B), which is B/2 - B^2/(6 A).
  const double perSquare = 0.25 - 0.25 / (6.0 * std::sqrt(0.5));
  EXPECT_NEAR(s.distance, 2.0 * perSquare / 14.0, 1e-4);
  s = scoreOf(l, {test::makeBox({0, 0, 0}, {2, 1, 1}), test::makeBox({0, 1, 0}, {1, 2, 1})});
  EXPECT_NEAR(s.score17, 1.0, 1e-12);
  EXPECT_NEAR(s.score16, 1.0, 1e-9);
}

TEST(Score, TorusHalfCoveredByASlantedBox) {
  // By symmetry any plane through the torus's centre halves it; this one is parallel to no axis.
  const TriMesh torus = test::makeTorus(2.0, 0.5, 96, 48);
  const Mat3 turn = Quat(0.7, 0.3, -0.5, 0.4).normalized().toRotationMatrix();
  const TriMesh half =
      test::moved(test::makeBox({0, -10, -10}, {10, 10, 10}), [&](const Vec3& p) -> Vec3 { return turn * p; });
  const double volume = signedVolume(torus.vertices, torus.triangles);
  const double truth = 0.5 * volume / (0.5 * volume + 4000.0);
  const Score s = scoreOf(torus, {half});
  EXPECT_NEAR(s.score16, truth, allowance(s));
  EXPECT_NEAR(s.uncoveredFraction, 0.5, 2e-3);
}

TEST(Score, StandardErrorIsHonestOverManySeeds) {
  // Of a ball around a corner of the cube, an eighth is inside: the facets are the same in all octants.
  const TriMesh ball = test::makeSphere(1.0, 40, 80);
  const double covered = signedVolume(ball.vertices, ball.triangles) / 8.0;
  ScoreSettings settings;
  settings.volumeSamples = 4000;
  settings.surfaceSamples = 1;
  const double truth = covered / (1.0 - covered + 8.0 * covered);
  double squares = 0.0;
  const int runs = 40;
  for (int i = 0; i < runs; ++i) {
    settings.seed = static_cast<std::uint64_t>(i);
    const Score s = scoreOf(kUnitCube, {ball}, settings);
    const double deviation = (s.score16 - truth) / s.score16StandardError;
    EXPECT_LT(std::abs(deviation), 4.5) << "seed " << i;
    squares += deviation * deviation;
  }
  // Student's t with 15 degrees of freedom has a standard deviation of 1.07.
  EXPECT_NEAR(std::sqrt(squares / runs), 1.07, 0.4);
}

TEST(Score, MoreLinesMeanASmallerError) {
  const TriMesh ball = test::makeSphere(1.0, 20, 40);
  const auto errorOf = [&](int lines) {
    return scoreOf(kUnitCube, {ball}, {.volumeSamples = lines}).score16StandardError;
  };
  EXPECT_LT(5.0 * errorOf(160000), errorOf(1600));
}

TEST(Score, RigidMotionAndScaleDoNotMatter) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const TriMesh l = test::makeLShape();
  const std::vector<TriMesh> parts = {test::makeBox({0.1, 0.2, -0.3}, {1.7, 0.9, 0.8}),
                                      test::makeBox({0.0, 0.7, 0.0}, {1.2, 2.2, 1.1})};
  const Score still = scoreOf(l, parts);
  for (int i = 0; i < 5; ++i) {
    const Quat rotation = Quat{normal(random), normal(random), normal(random), normal(random)}.normalized();
    const double scale = std::exp(normal(random));
    const Vec3 shift{normal(random), normal(random), normal(random)};
    const auto moved = [&](const TriMesh& mesh) {
      return test::moved(mesh, [&](const Vec3& p) -> Vec3 { return scale * (rotation * p + shift); });
    };
    const Score s = scoreOf(moved(l), {moved(parts[0]), moved(parts[1])});
    EXPECT_NEAR(s.score16, still.score16, allowance(s) + allowance(still));
    EXPECT_NEAR(s.score17, still.score17, 1e-12);
    EXPECT_NEAR(s.distance, scale * still.distance, 1e-9 * scale);
  }
}

TEST(Score, SameSeedSameScore) {
  const TriMesh l = test::makeLShape();
  const std::vector<TriMesh> parts = {test::makeBox({0.1, 0.2, -0.3}, {1.7, 0.9, 0.8})};
  ScoreSettings settings;
  const Score a = scoreOf(l, parts, settings);
  const Score b = scoreOf(l, parts, settings);
  EXPECT_EQ(a.score16, b.score16);
  EXPECT_EQ(a.distance, b.distance);
  settings.seed = 2;
  EXPECT_NE(a.score16, scoreOf(l, parts, settings).score16);
}

TEST(Score, HollowMeshIsEmptyInside) {
  const Score s = scoreOf(test::makeHollowBox(), {test::makeBox({1, 1, 1}, {2, 2, 2})});
  EXPECT_NEAR(s.uncoveredFraction, 1.0, 1e-12);  // the part fills the cavity only
}

TEST(Score, FlatPartsCountInDistanceOnly) {
  // A square in the cube's middle plane x = 0.5 beside a part far away.
  const TriMesh flat{{{0.5, 0, 0}, {0.5, 1, 0}, {0.5, 1, 1}, {0.5, 0, 1}}, {{0, 1, 2}, {0, 2, 3}}};
  const TriMesh far = test::makeBox({100, 0, 0}, {101, 1, 1});
  const Score s = scoreOf(kUnitCube, {far, flat});
  EXPECT_DOUBLE_EQ(s.score17, 1.0);
  EXPECT_EQ(s.uncoveredFraction, 1.0);
  EXPECT_NEAR(s.distance, (2 * 0.5 + 4 * 0.25) / 6.0, 1e-3);
}

TEST(Score, DistancesBothWaysAndConcavityOfAnLShape) {
  // One hull of an L of three unit squares: the middle of its slanted face is 1/2 from the L, the middle of the inner
  // edge 1/2 below the end faces. The mesh's longest side is 2, so the unit of concavity is 1.
  const TriMesh shape = test::makeLShape();
  const Score s = scoreOf(shape, {shape});
  EXPECT_NEAR(s.concavity, 0.5, 0.01);
  EXPECT_DOUBLE_EQ(s.meanConcavity, s.concavity);
  EXPECT_NEAR(s.toHulls.largest, 0.5, 0.02);
  EXPECT_NEAR(s.toSurface.largest, 0.5, 0.02);
  EXPECT_DOUBLE_EQ(s.toHulls.mean, s.distance);
  EXPECT_LE(s.toHulls.most, s.toHulls.largest);
  // Two boxes fit exactly, and the face between them is in the mesh.
  const Score exact = scoreOf(shape, {test::makeBox({0, 0, 0}, {2, 1, 1}), test::makeBox({0, 1, 0}, {1, 2, 1})});
  EXPECT_NEAR(exact.score17, 1.0, 1e-12);
  EXPECT_NEAR(exact.toSurface.largest, 0.0, 1e-6);
  EXPECT_NEAR(exact.concavity, 0.0, 0.02);
}

TEST(Score, OfASurfaceThatABodyWasMadeFor) {
  // The body is a box, the file's surface only its floor.
  const TriMesh box = test::makeBox({0, 0, 0}, {1, 1, 1});
  const TriMesh lid{{{0, 2, 0}, {1, 2, 0}, {1, 2, 1}}, {{0, 2, 1}}};
  const Score s = test::valueOf(score(box, std::vector<TriMesh>{box}, {}, &lid));
  EXPECT_NEAR(s.toHulls.largest, 1.0, 1e-9);
  EXPECT_NEAR(s.score17, 1.0, 1e-12);
}

TEST(Score, BadInputIsRefused) {
  const std::vector<TriMesh> parts = {kUnitCube};
  TriMesh open = kUnitCube, notFinite = kUnitCube, outOfRange = kUnitCube;
  open.triangles.pop_back();
  notFinite.vertices[3].x() = std::nan("");
  outOfRange.triangles[2][0] = 8;
  EXPECT_EQ(score(open, parts, {}).error().code, ErrorCode::kBadMesh);
  EXPECT_NE(score(open, parts, {}).error().message.find("the mesh is open"), std::string::npos);
  struct Row {
    TriMesh mesh;
    std::vector<TriMesh> parts;
    ScoreSettings settings;
    std::string message;
  };
  const TriMesh flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  for (const Row& row : std::initializer_list<Row>{
           {kUnitCube, {}, {}, "none of the 0 parts has a volume"},
           {kUnitCube, {flat, {}}, {}, "none of the 2 parts has a volume"},
           {kUnitCube, {kUnitCube, notFinite}, {}, "part 1: vertex 3 is not finite"},
           {kUnitCube, {kUnitCube, outOfRange}, {}, "part 1: triangle 2: vertex index 8 is out of range (8 vertices)"},
           {kUnitCube, parts, {.volumeSamples = 15}, "volumeSamples is 15, expected 16 or more"},
           {kUnitCube,
            parts,
            {.surfaceSamples = 0},
            "surfaceSamples is 0, concavitySamples 2000: expected 1 or more of each"}}) {
    EXPECT_EQ(score(row.mesh, row.parts, row.settings).error().message, row.message);
  }
}

TEST(Score, BunnyByItsHull) {
  LORICA_REQUIRE_DATASET(file, "vhacd/Bunny.off");
  const auto bunny = test::valueOf(readMesh(file));
  const Score s = scoreOf(bunny, {bunny});
  EXPECT_NEAR(s.score17, signedVolume(bunny.vertices, bunny.triangles) / convexHullVolume(bunny.vertices), 1e-12);
  EXPECT_NEAR(s.score16, s.score17, 1e-9);
  EXPECT_GT(s.distancePercentDiagonal, 0.1);
}

}  // namespace
}  // namespace lorica
