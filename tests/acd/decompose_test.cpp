#include "acd/decompose.h"

#include "acd/cut.h"
#include "acd/transfer.h"
#include "geometry/mesh_files.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace lorica {
namespace {

Decomposition decomposed(const TriMesh& mesh, const DecomposeSettings& settings) {
  Result<Decomposition> result = decompose(mesh, {mesh.vertices, static_cast<int>(mesh.vertices.size())}, settings);
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().message);
  return std::move(*result);
}

std::vector<Vec3> carried(const Decomposition& d, std::span<const Vec3> posed) {
  std::vector<Vec3> points(static_cast<std::size_t>(d.pointCount()));
  transfer(d, posed, points);
  return points;
}

/// Checks: every part closed with positive volume, volumes add up to the mesh's, every vertex inside a hull, sources
/// tracked.
void expectSound(const TriMesh& mesh, std::span<const Vec3> posed, const Decomposition& d) {
  const std::vector<Vec3> points = carried(d, posed);
  const double meshVolume = signedVolume(posed, mesh.triangles);
  const double diagonal = boundsOf(posed).diagonal();
  double sum = 0.0;
  std::vector<bool> covered(posed.size(), false);
  for (const Part& part : d.parts) {
    std::map<std::pair<PointIndex, PointIndex>, int> balance;
    for (const Triangle& t : part.triangles) {
      for (int e = 0; e < 3; ++e) {
        ++balance[{t[e], t[(e + 1) % 3]}];
        --balance[{t[(e + 1) % 3], t[e]}];
      }
    }
    for (const auto& [edge, count] : balance) ASSERT_EQ(count, 0) << "open edge";
    sum += signedVolume(points, part.triangles);
    ASSERT_EQ(part.sourceTriangle.size(), part.triangles.size());
    ASSERT_EQ(part.points, pointsUsedBy(part.triangles));
    std::vector<Vec3> own;
    for (PointIndex p : part.points) {
      own.push_back(points[p]);
      if (p < d.vertexCount) covered[p] = true;
    }
    const ConvexHull hull = partHull(part, points);
    EXPECT_LE(largestViolation(hull, own), 1e-6 * diagonal);
  }
  EXPECT_NEAR(sum, meshVolume, 1e-9 * std::abs(meshVolume));
  for (std::size_t i = 0; i < covered.size(); ++i) EXPECT_TRUE(covered[i]) << "vertex " << i << " is in no part";
  for (std::size_t i = 0; i < d.cutPoints.size(); ++i) {
    const PointIndex self = d.vertexCount + static_cast<PointIndex>(i);
    EXPECT_LT(d.cutPoints[i].first, self);
    EXPECT_LT(d.cutPoints[i].second, self);
    EXPECT_GT(d.cutPoints[i].lambda, 0.0);
    EXPECT_LT(d.cutPoints[i].lambda, 1.0);
  }
  EXPECT_EQ(d.splitFrom.size() + 1, d.parts.size());
}

TEST(Decompose, RefusesWhatIsNotClosed) {
  TriMesh open = test::makeLShape();
  open.triangles.pop_back();
  const auto result = decompose(open, {open.vertices, static_cast<int>(open.vertices.size())}, {});
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::kBadMesh);
}

TEST(Decompose, RefusesSettingsOutOfRange) {
  const TriMesh mesh = test::makeLShape();
  const PoseView pose{mesh.vertices, static_cast<int>(mesh.vertices.size())};
  for (const DecomposeSettings& bad : {DecomposeSettings{.maxParts = -1}, DecomposeSettings{.candidateEdges = -1},
                                       DecomposeSettings{.planesPerEdge = -1}, DecomposeSettings{.threads = -1}}) {
    EXPECT_EQ(decompose(mesh, pose, bad).error().code, ErrorCode::kInvalidArgument);
  }
  const PoseView wrongCount{std::span(mesh.vertices).subspan(1), static_cast<int>(mesh.vertices.size()) - 1};
  EXPECT_EQ(decompose(mesh, wrongCount, {}).error().code, ErrorCode::kInvalidArgument);
}

TEST(Decompose, AConvexMeshIsNotCut) {
  for (const TriMesh& mesh :
       {test::makeBox({0, 0, 0}, {1, 2, 3}), test::makeTetrahedron(), test::makeSphere(1, 12, 20)}) {
    EXPECT_EQ(decomposed(mesh, {.maxParts = 8}).parts.size(), 1u);
  }
}

TEST(Decompose, TheLShapeFallsIntoTwoExactBoxes) {
  const TriMesh mesh = test::makeLShape();
  const Decomposition d = decomposed(mesh, {.maxParts = 0});
  expectSound(mesh, mesh.vertices, d);
  ASSERT_EQ(d.parts.size(), 2u);
  EXPECT_NEAR(errorInPose(d, mesh, mesh.vertices).relative(), 0.0, 1e-12);
}

TEST(Decompose, SeparateBoxesAreTakenApartByAPlaneBetweenThem) {
  const TriMesh mesh = test::joined(test::makeBox({0, 0, 0}, {1, 1, 1}), test::makeBox({2, 0.3, 0.2}, {3, 1, 1}));
  const Decomposition d = decomposed(mesh, {.maxParts = 2});
  expectSound(mesh, mesh.vertices, d);
  ASSERT_EQ(d.parts.size(), 2u);
  EXPECT_NEAR(errorInPose(d, mesh, mesh.vertices).relative(), 0.0, 1e-12);
  EXPECT_TRUE(d.cutPoints.empty());
}

TEST(Decompose, ACavityIsCutOpenNotLeftInsideOut) {
  TriMesh cavity = test::makeBox({1, 1, 1}, {2, 2, 2});
  for (Triangle& t : cavity.triangles) std::swap(t[1], t[2]);
  const TriMesh mesh = test::joined(test::makeBox({0, 0, 0}, {3, 3, 3}), cavity);
  const Decomposition d = decomposed(mesh, {.maxParts = 0});
  expectSound(mesh, mesh.vertices, d);
  EXPECT_NEAR(errorInPose(d, mesh, mesh.vertices).relative(), 0.0, 1e-9);
  EXPECT_GE(d.parts.size(), 4u);
}

TEST(Decompose, ATorusOpensAndStaysClosed) {
  const TriMesh mesh = test::makeTorus(1.0, 0.3, 24, 12);
  double last = 1e9;
  for (int parts = 1; parts <= 12; ++parts) {
    const Decomposition d = decomposed(mesh, {.maxParts = parts, .preset = DecomposePreset::kPaper});
    EXPECT_EQ(static_cast<int>(d.parts.size()), parts);
    expectSound(mesh, mesh.vertices, d);
    const double error = errorInPose(d, mesh, mesh.vertices).relative();
    // Planes divide the positions that are rounded to a grid.
    EXPECT_LE(error, last + 1e-9) << "error rose at " << parts << " parts";
    last = error;
  }
}

TEST(Decompose, OneThreadEqualsFour) {
  const TriMesh mesh = test::makeTorus(1.0, 0.4, 40, 20);
  const std::uint64_t once = hashOf(decomposed(mesh, {.maxParts = 10, .threads = 1}));
  EXPECT_EQ(once, hashOf(decomposed(mesh, {.maxParts = 10, .threads = 4})));
  EXPECT_EQ(once, hashOf(decomposed(mesh, {.maxParts = 10, .threads = 1})));
}

TEST(Decompose, PrefixOfTheCutsIsTheSmallerDecomposition) {
  const TriMesh mesh = test::makeTorus(1.0, 0.4, 30, 12);
  const Decomposition few = decomposed(mesh, {.maxParts = 4, .preset = DecomposePreset::kPaper});
  const Decomposition many = decomposed(mesh, {.maxParts = 9, .preset = DecomposePreset::kPaper});
  for (std::size_t i = 0; i < few.splitFrom.size(); ++i) {
    EXPECT_EQ(few.splitFrom[i], many.splitFrom[i]);
  }
}

TEST(Decompose, CancellingStopsIt) {
  const TriMesh mesh = test::makeTorus(1.0, 0.4, 30, 12);
  DecomposeSettings settings{.maxParts = 12};
  settings.progress = [](int done, int) { return done < 5; };
  const auto result = decompose(mesh, {mesh.vertices, static_cast<int>(mesh.vertices.size())}, settings);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::kCancelled);
}

TEST(Decompose, ScaleAndRigidMotionKeepTheError) {
  // Without symmetry: between equal candidates rounding would decide.
  TriMesh mesh = test::makeTorus(1.0, 0.4, 30, 12);
  for (Vec3& v : mesh.vertices)
    v += 0.15 * Vec3(std::sin(2 * v.z() + 1), std::sin(1.7 * v.x()), std::cos(1.3 * v.x() + 0.4 * v.z()));
  const double error =
      errorInPose(decomposed(mesh, {.maxParts = 6, .preset = DecomposePreset::kPaper}), mesh, mesh.vertices).relative();
  for (const double scale : {1e-6, 1.0, 1e6}) {
    TriMesh moved = mesh;
    const Quat q = Quat(0.2, 0.5, -0.4, 0.7).normalized();
    for (Vec3& v : moved.vertices) v = scale * (q * v + Vec3(1, 2, 3));
    const Decomposition d = decomposed(moved, {.maxParts = 6, .preset = DecomposePreset::kPaper});
    expectSound(moved, moved.vertices, d);
    EXPECT_NEAR(errorInPose(d, moved, moved.vertices).relative(), error, 1e-9);
  }
}

/// A bar of two halves that bends at the middle by an angle: an elbow with a closed form.
std::vector<Vec3> bent(const TriMesh& bar, double angle) {
  std::vector<Vec3> posed;
  for (const Vec3& v : bar.vertices) {
    const double t = std::clamp(v.x() + 0.5, 0.0, 1.0) * angle;
    posed.push_back(Eigen::AngleAxisd(t, Vec3::UnitZ()) * v);
  }
  return posed;
}

TriMesh makeBar() {
  TriMesh bar = test::makeSphere(0.5, 16, 16);
  for (Vec3& v : bar.vertices) {
    // A capsule along x.
    v = Vec3(v.y(), v.z(), v.x());
    v.x() += v.x() > 0 ? 1.5 : -1.5;
  }
  return bar;
}

TEST(DecomposeAnimated, TheBendIsCutAlthoughTheFirstKeyframeIsStraight) {
  const TriMesh bar = makeBar();
  std::vector<Vec3> keyframes;
  for (const double angle : {0.0, 0.7, 1.4}) {
    const std::vector<Vec3> pose = bent(bar, angle);
    keyframes.insert(keyframes.end(), pose.begin(), pose.end());
  }
  const int n = static_cast<int>(bar.vertices.size());
  const auto all = decompose(bar, {keyframes, n}, {.maxParts = 3});
  ASSERT_TRUE(all.ok()) << all.error().message;
  const auto first = decompose(bar, {std::span(keyframes).first(bar.vertices.size()), n}, {.maxParts = 3});
  ASSERT_TRUE(first.ok());
  EXPECT_EQ(first->parts.size(), 1u) << "straight, the bar is convex";
  EXPECT_EQ(all->parts.size(), 3u);
  double errorOfAll = 0.0, errorOfFirst = 0.0;
  for (const double unseen : {0.3, 1.0, 1.3}) {
    const std::vector<Vec3> pose = bent(bar, unseen);
    expectSound(bar, pose, *all);
    errorOfAll += errorInPose(*all, bar, pose).relative();
    errorOfFirst += errorInPose(*first, bar, pose).relative();
  }
  EXPECT_LT(errorOfAll, 0.5 * errorOfFirst);
}

TEST(Decompose, TellsHowManyPartsThereAreWhenNoneWereAskedFor) {
  std::vector<int> told;
  const Decomposition d = decomposed(test::makeTorus(1.0, 0.4, 12, 6), {.maxParts = 0, .progress = [&](int done, int) {
                                                                          told.push_back(done);
                                                                          return true;
                                                                        }});
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(*std::min_element(told.begin(), told.end()), 1);
  EXPECT_EQ(told.back(), static_cast<int>(d.parts.size()));
}

/// Merges parts from `count` on into the parts that they were split from, in level-of-detail order.
Decomposition coarser(Decomposition d, std::size_t count) {
  while (d.parts.size() > count) {
    Part& into = d.parts[d.splitFrom.back()];
    const Part last = d.parts.back();
    d.parts.pop_back();
    d.splitFrom.pop_back();
    into.triangles.insert(into.triangles.end(), last.triangles.begin(), last.triangles.end());
    into.sourceTriangle.insert(into.sourceTriangle.end(), last.sourceTriangle.begin(), last.sourceTriangle.end());
    into.points = pointsUsedBy(into.triangles);
  }
  return d;
}

class Presets : public testing::TestWithParam<DecomposePreset> {};

TEST_P(Presets, EveryPrefixIsASoundDecomposition) {
  const TriMesh mesh = test::joined(test::makeTorus(1.0, 0.4, 24, 12), test::makeBox({2, 0, 0}, {3, 1, 1}));
  const Decomposition d = decomposed(mesh, {.maxParts = 9, .preset = GetParam(), .threads = 1});
  EXPECT_EQ(d.parts.size(), 9u);
  const double finest = errorInPose(d, mesh, mesh.vertices).relative();
  double error = 0.0;
  for (std::size_t count = 9; count >= 1; --count) {
    const Decomposition level = coarser(d, count);
    expectSound(mesh, mesh.vertices, level);
    error = errorInPose(level, mesh, mesh.vertices).relative();
    EXPECT_GE(error, finest) << count << " parts";
  }
  EXPECT_NEAR(error, convexHullVolume(mesh.vertices) / signedVolume(mesh.vertices, mesh.triangles) - 1.0, 1e-9);
  EXPECT_EQ(hashOf(d), hashOf(decomposed(mesh, {.maxParts = 9, .preset = GetParam(), .threads = 3})));
}

std::string presetName(const testing::TestParamInfo<DecomposePreset>& info) {
  const std::array<const char*, 3> names = {"paper", "fast", "quality"};
  return names[static_cast<std::size_t>(info.param)];
}

INSTANTIATE_TEST_SUITE_P(Decompose, Presets,
                         testing::Values(DecomposePreset::kPaper, DecomposePreset::kFast, DecomposePreset::kQuality),
                         presetName);

struct BenchmarkRow {
  const char* file;
  int parts;
  DecomposePreset preset;
  double score;
};

void PrintTo(const BenchmarkRow& row, std::ostream* out) {
  *out << row.file << ", " << row.parts << " parts";
}

class VhacdBenchmark : public testing::TestWithParam<BenchmarkRow> {};

TEST_P(VhacdBenchmark, ReachesItsScoreAndStaysSound) {
  LORICA_REQUIRE_DATASET(file, std::string("vhacd/") + GetParam().file);
  const Result<TriMesh> mesh = readMesh(file);
  ASSERT_TRUE(mesh.ok()) << mesh.error().message;
  const Decomposition d = decomposed(*mesh, {.maxParts = GetParam().parts, .preset = GetParam().preset});
  expectSound(*mesh, mesh->vertices, d);
  EXPECT_GE(1.0 / (1.0 + errorInPose(d, *mesh, mesh->vertices).relative()), GetParam().score);
}

constexpr DecomposePreset kPaper = DecomposePreset::kPaper;
constexpr DecomposePreset kFast = DecomposePreset::kFast;
INSTANTIATE_TEST_SUITE_P(
    Decompose, VhacdBenchmark,
    testing::Values(BenchmarkRow{"Bunny.off", 8, kPaper, 0.89}, BenchmarkRow{"Bunny.off", 28, kPaper, 0.95},
                    BenchmarkRow{"Block.off", 19, kPaper, 0.90}, BenchmarkRow{"Horse.off", 10, kPaper, 0.80},
                    BenchmarkRow{"Bunny.off", 8, kFast, 0.89}, BenchmarkRow{"Block.off", 19, kFast, 0.92},
                    BenchmarkRow{"Horse.off", 10, kFast, 0.84}, BenchmarkRow{"Table.off", 5, kFast, 0.99},
                    BenchmarkRow{"Octopus.off", 31, kFast, 0.70}, BenchmarkRow{"Genus.off", 12, kFast, 0.82}));

}  // namespace
}  // namespace lorica
