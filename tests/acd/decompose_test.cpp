#include "acd/decompose.h"

#include "acd/fewer_parts.h"
#include "acd/improve.h"
#include "acd/part_concavity.h"
#include "acd/transfer.h"
#include "geometry/convex_hull.h"
#include "geometry/files.h"
#include "geometry/mesh_files.h"
#include "geometry/random_numbers.h"
#include "geometry/small_faults.h"
#include "tests/acd/parts.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

namespace lorica {
namespace {

using test::decomposed;

/// Checks: every part closed with positive volume, volumes add up to the mesh's, every vertex inside a hull, sources
/// tracked.
void expectSound(const TriMesh& mesh, std::span<const Vec3> posed, const Decomposition& d) {
  const std::vector<Vec3> points = test::transferred(d, posed);
  const double meshVolume = signedVolume(posed, mesh.triangles);
  const double diagonal = boundsOf(posed).diagonal();
  double sum = 0.0;
  std::vector<bool> covered(posed.size(), false);
  for (const Part& part : d.parts) {
    ASSERT_TRUE(test::isClosed(part.triangles));
    sum += signedVolume(points, part.triangles);
    ASSERT_EQ(part.sourceTriangle.size(), part.triangles.size());
    ASSERT_EQ(part.points, pointsUsedBy(part.triangles));
    for (const PointIndex p : part.points) {
      if (p < d.vertexCount) covered[p] = true;
    }
    EXPECT_LE(largestViolation(partHull(part, points), test::chosen(part.points, points)), 1e-6 * diagonal);
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

TEST(Decompose, RefusesWhatIsNotClosedAndSettingsOutOfRange) {
  const TriMesh mesh = test::makeLShape();
  TriMesh open = mesh;
  open.triangles.pop_back();
  EXPECT_EQ(decompose(open, test::poseOf(open), {}).error().code, ErrorCode::kBadMesh);
  for (const DecomposeSettings& bad : {DecomposeSettings{.maxParts = -1}, DecomposeSettings{.candidateEdges = -1},
                                       DecomposeSettings{.planesPerEdge = -1}, DecomposeSettings{.threads = -1}}) {
    EXPECT_EQ(decompose(mesh, test::poseOf(mesh), bad).error().code, ErrorCode::kInvalidArgument);
  }
  const PoseView wrongCount{std::span(mesh.vertices).subspan(1), countOf(mesh.vertices) - 1};
  EXPECT_EQ(decompose(mesh, wrongCount, {}).error().code, ErrorCode::kInvalidArgument);
}

TEST(Decompose, AConvexMeshIsNotCut) {
  for (const TriMesh& mesh :
       {test::makeBox({0, 0, 0}, {1, 2, 3}), test::makeTetrahedron(), test::makeSphere(1, 12, 20)}) {
    EXPECT_EQ(decomposed(mesh, {.maxParts = 8}).parts.size(), 1u);
  }
}

TEST(Decompose, TheNumberOfPartsIsALimit) {
  const TriMesh boxes =
      test::joined(test::makeBox({0, 0, 0}, {3, 1, 1}),
                   test::joined(test::makeBox({0, 0, 0}, {1, 3, 1}), test::makeBox({2, 0, 0}, {3, 3, 1})));
  const TriMesh mesh = test::valueOf(repairSmallFaults(boxes)).mesh;
  for (const DecomposePreset preset : {DecomposePreset::kFast, DecomposePreset::kQuality}) {
    for (const int most : {3, 4, 8, 16, 0}) {
      const Decomposition d = decomposed(mesh, {.maxParts = most, .preset = preset});
      EXPECT_EQ(d.parts.size(), 3u) << most << " parts";
      double volume = 0.0;
      for (const Part& part : d.parts) volume += partHull(part, test::transferred(d, mesh.vertices)).volume;
      EXPECT_NEAR(volume, 7.0, 1e-9);
      EXPECT_EQ(d.splitFrom.size(), 2u);
    }
  }
}

TEST(Decompose, RoundedCoordinatesAreNoConcavity) {
  const TriMesh ball = test::makeSphere(1.0, 24, 36);
  const auto rounded = [&](double digits) {
    return test::moved(ball, [&](const Vec3& p) -> Vec3 { return (digits * p).array().round() / digits; });
  };
  for (const double digits : {1e5, 1e6, 1e7}) {
    for (const int most : {0, 16}) {
      EXPECT_EQ(decomposed(rounded(digits), {.maxParts = most}).parts.size(), 1u) << digits << ", " << most;
    }
  }
  // A notch that is as small in volume, but deep.
  TriMesh notched = ball;
  notched.vertices[400] *= 0.95;
  EXPECT_GT(decomposed(notched, {.maxParts = 0}).parts.size(), 1u);
}

TEST(Decompose, BoxesThatFormAMeshAreItsParts) {
  struct Row {
    const char* what;
    TriMesh mesh;
    int maxParts;
    std::size_t least, most;  ///< parts
    double tolerance;
  };
  const TriMesh apart = test::joined(test::makeBox({0, 0, 0}, {1, 1, 1}), test::makeBox({2, 0.3, 0.2}, {3, 1, 1}));
  for (const Row& row :
       {Row{"an L-shape", test::makeLShape(), 0, 2, 2, 1e-12}, Row{"separate boxes", apart, 2, 2, 2, 1e-12},
        Row{"a cavity is cut open, not left inside out", test::makeHollowBox(), 0, 4, 99, 1e-9}}) {
    SCOPED_TRACE(row.what);
    const Decomposition d = decomposed(row.mesh, {.maxParts = row.maxParts});
    expectSound(row.mesh, row.mesh.vertices, d);
    EXPECT_GE(d.parts.size(), row.least);
    EXPECT_LE(d.parts.size(), row.most);
    EXPECT_NEAR(errorInPose(d, row.mesh, row.mesh.vertices).relative(), 0.0, row.tolerance);
  }
  EXPECT_TRUE(decomposed(apart, {.maxParts = 2}).cutPoints.empty()) << "a plane between them";
}

TEST(Decompose, ATorusOpensAndStaysClosed) {
  const TriMesh mesh = test::makeTorus(1.0, 0.3, 24, 12);
  double last = 1e9;
  for (int parts = 1; parts <= 12; ++parts) {
    const Decomposition d = decomposed(mesh, {.maxParts = parts, .preset = DecomposePreset::kPaper});
    EXPECT_EQ(countOf(d.parts), parts);
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

/// The ends of a gear are level but for rounding: with twenty times as many its hulls took minutes.
TEST(Decompose, AGearOfVeryManyTeethIsOnePart) {
  constexpr int kTeeth = 1'000;
  TriMesh gear;
  for (int i = 0; i < 2 * kTeeth; ++i) {
    const double radius = i % 2 == 1 ? 1.0 : 0.98, angle = M_PI * i / kTeeth;
    for (const double z : {0.0, 0.1}) gear.vertices.emplace_back(radius * cos(angle), radius * sin(angle), z);
  }
  gear.vertices.emplace_back(0.0, 0.0, 0.0);
  gear.vertices.emplace_back(0.0, 0.0, 0.1);
  for (int i = 0; i < 2 * kTeeth; ++i) {
    const VertexIndex a = 2 * i, b = 2 * ((i + 1) % (2 * kTeeth)), middle = 4 * kTeeth;
    gear.triangles.insert(gear.triangles.end(),
                          {{a, b, b + 1}, {a, b + 1, a + 1}, {middle, b, a}, {middle + 1, a + 1, b + 1}});
  }
  const Decomposition d = decomposed(gear, {.maxConcavity = 0.05});
  ASSERT_EQ(d.parts.size(), 1u);
  EXPECT_NEAR(partHull(d.parts[0], test::transferred(d, gear.vertices)).volume,
              0.1 * 0.5 * kTeeth * std::sin(2.0 * M_PI / kTeeth), 1e-9);
}

TEST(Decompose, CancellingStopsIt) {
  const TriMesh mesh = test::makeTorus(1.0, 0.4, 30, 12);
  const auto result =
      decompose(mesh, test::poseOf(mesh), {.maxParts = 12, .progress = [](int done, int) { return done < 5; }});
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::kCancelled);
}

TEST(Decompose, ScaleAndRigidMotionKeepTheError) {
  // Without symmetry: between equal candidates rounding would decide.
  const TriMesh mesh = test::moved(test::makeTorus(1.0, 0.4, 30, 12), [](const Vec3& v) -> Vec3 {
    return v + 0.15 * Vec3(std::sin(2 * v.z() + 1), std::sin(1.7 * v.x()), std::cos(1.3 * v.x() + 0.4 * v.z()));
  });
  const DecomposeSettings settings{.maxParts = 6, .preset = DecomposePreset::kPaper};
  const double error = errorInPose(decomposed(mesh, settings), mesh, mesh.vertices).relative();
  const Quat q = Quat(0.2, 0.5, -0.4, 0.7).normalized();
  for (const double scale : {1e-6, 1.0, 1e6}) {
    const TriMesh moved = test::moved(mesh, [&](const Vec3& v) -> Vec3 { return scale * (q * v + Vec3(1, 2, 3)); });
    const Decomposition d = decomposed(moved, settings);
    expectSound(moved, moved.vertices, d);
    EXPECT_NEAR(errorInPose(d, moved, moved.vertices).relative(), error, 1e-9);
  }
}

/// A bar of two halves that bends at the middle by an angle: an elbow with a closed form.
std::vector<Vec3> bent(const TriMesh& bar, double angle) {
  return test::moved(bar,
                     [&](const Vec3& v) -> Vec3 {
                       return Eigen::AngleAxisd(std::clamp(v.x() + 0.5, 0.0, 1.0) * angle, Vec3::UnitZ()) * v;
                     })
      .vertices;
}

/// A capsule along x.
TriMesh makeBar() {
  return test::moved(test::makeSphere(0.5, 16, 16),
                     [](const Vec3& v) { return Vec3(v.y() + (v.y() > 0 ? 1.5 : -1.5), v.z(), v.x()); });
}

/// The mesh with its vertices and triangles in another order.
TriMesh reordered(const TriMesh& mesh, RandomNumbers& random) {
  const auto shuffled = [&](std::size_t count) {
    std::vector<std::pair<double, int>> order;
    for (std::size_t i = 0; i < count; ++i) order.emplace_back(random.unit(), static_cast<int>(i));
    std::sort(order.begin(), order.end());
    return order;
  };
  TriMesh result;
  std::vector<VertexIndex> numberOf(mesh.vertices.size());
  for (const auto& [key, v] : shuffled(mesh.vertices.size())) {
    numberOf[v] = static_cast<VertexIndex>(result.vertices.size());
    result.vertices.push_back(mesh.vertices[v]);
  }
  for (const auto& [key, t] : shuffled(mesh.triangles.size())) {
    const auto& [a, b, c] = mesh.triangles[t];
    result.triangles.push_back({numberOf[b], numberOf[c], numberOf[a]});
  }
  return result;
}

TEST(Decompose, OfARigidMeshItsSurfaceAloneDecides) {
  RandomNumbers random(16);
  DecomposeSettings settings;
  settings.maxParts = 6;
  settings.rigid = true;
  const TriMesh table = test::makeVoxelSurface({{0, 0, 0},
                                                {4, 0, 0},
                                                {0, 0, 3},
                                                {4, 0, 3},
                                                {0, 1, 0},
                                                {1, 1, 0},
                                                {2, 1, 0},
                                                {3, 1, 0},
                                                {4, 1, 0},
                                                {0, 1, 1},
                                                {4, 1, 1},
                                                {0, 1, 2},
                                                {4, 1, 2},
                                                {0, 1, 3},
                                                {1, 1, 3},
                                                {2, 1, 3},
                                                {3, 1, 3},
                                                {4, 1, 3}});
  for (const TriMesh& mesh : {table, test::makeTorus(1.0, 0.3, 24, 12), test::makeLShape()}) {
    const auto volumesOf = [&](const TriMesh& given) {
      const Decomposition parts =
          test::valueOf(decompose(given, {given.vertices, static_cast<int>(given.vertices.size())}, settings));
      const std::vector<Vec3> points = test::transferred(parts, given.vertices);
      std::vector<double> volumes;
      double sum = 0.0;
      for (const Part& part : parts.parts) {
        volumes.push_back(partHull(part, points).volume);
        sum += signedVolume(points, part.triangles);
        EXPECT_TRUE(test::isClosed(part.triangles));
        EXPECT_EQ(part.points, pointsUsedBy(part.triangles));
        for (const std::int32_t source : part.sourceTriangle) {
          EXPECT_LT(source, static_cast<std::int32_t>(given.triangles.size()));
        }
      }
      EXPECT_NEAR(sum, signedVolume(given.vertices, given.triangles), 1e-9);
      std::sort(volumes.begin(), volumes.end());
      return volumes;
    };
    const std::vector<double> volumes = volumesOf(mesh);
    EXPECT_GT(volumes.size(), 1u);
    for (int times = 0; times < 3; ++times) {
      const std::vector<double> other = volumesOf(reordered(test::divided(mesh, times), random));
      ASSERT_EQ(other.size(), volumes.size());
      for (std::size_t i = 0; i < volumes.size(); ++i) EXPECT_NEAR(other[i], volumes[i], 1e-9);
    }
  }
  settings.maxParts = 2;
  const std::vector<Vec3> twice(2 * table.vertices.size(), Vec3::Zero());
  EXPECT_EQ(decompose(table, {twice, static_cast<int>(table.vertices.size())}, settings).error().code,
            ErrorCode::kInvalidArgument);
}

TEST(DecomposeAnimated, TheBendIsCutAlthoughTheFirstKeyframeIsStraight) {
  const TriMesh bar = makeBar();
  std::vector<Vec3> keyframes;
  for (const double angle : {0.0, 0.7, 1.4}) {
    const std::vector<Vec3> pose = bent(bar, angle);
    keyframes.insert(keyframes.end(), pose.begin(), pose.end());
  }
  const Decomposition all = decomposed(bar, {keyframes, countOf(bar.vertices)}, {.maxParts = 3});
  const Decomposition first = decomposed(bar, {.maxParts = 3});
  EXPECT_EQ(first.parts.size(), 1u) << "straight, the bar is convex";
  EXPECT_EQ(all.parts.size(), 3u);
  double errorOfAll = 0.0, errorOfFirst = 0.0;
  for (const double unseen : {0.3, 1.0, 1.3}) {
    const std::vector<Vec3> pose = bent(bar, unseen);
    expectSound(bar, pose, all);
    errorOfAll += errorInPose(all, bar, pose).relative();
    errorOfFirst += errorInPose(first, bar, pose).relative();
  }
  EXPECT_LT(errorOfAll, 0.5 * errorOfFirst);
}

TEST(Decompose, TellsHowManyPartsThereAreWhenNoneWereAskedFor) {
  std::vector<int> told;
  const auto progress = [&](int done, int) {
    told.push_back(done);
    return true;
  };
  const Decomposition d = decomposed(test::makeTorus(1.0, 0.4, 12, 6), {.maxParts = 0, .progress = progress});
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(*std::min_element(told.begin(), told.end()), 1);
  EXPECT_EQ(told.back(), countOf(d.parts));
}

TEST(Decompose, TellsHowManyPartsAreExpectedWhenALimitIsMetBeforeTheirNumber) {
  int told = 0, last = 0, most = 0;
  const auto progress = [&](int done, int total) {
    told = done;
    last = total;
    most = std::max(most, total);
    return true;
  };
  const Decomposition d =
      decomposed(test::makeTorus(1.0, 0.4, 24, 12), {.maxParts = 256, .maxConcavity = 0.2, .progress = progress});
  ASSERT_LT(countOf(d.parts), 64);
  EXPECT_EQ(told, last);
  EXPECT_LT(most, 256);
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
  const TriMesh mesh = test::valueOf(readMesh(file));
  const Decomposition d = decomposed(mesh, {.maxParts = GetParam().parts, .preset = GetParam().preset});
  expectSound(mesh, mesh.vertices, d);
  EXPECT_GE(1.0 / (1.0 + errorInPose(d, mesh, mesh.vertices).relative()), GetParam().score);
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

/// Of a ring, or of thin walls round a hole, every cut gains next to nothing, and only some lead on.
TEST(Decompose, MeetsAConcavityWithFewPartsWhereNoCutGains) {
  const std::vector<std::pair<std::string, std::size_t>> rows = {
      {"Block.off", 20}, {"Sledge.off", 14}, {"Torus.off", 8}};
  for (const auto& [name, parts] : rows) {
    LORICA_REQUIRE_DATASET(file, "vhacd/" + name);
    const TriMesh mesh = test::valueOf(readMesh(file));
    const double limit = 0.048 * concavityUnit(mesh.vertices);
    const Decomposition d = decomposed(mesh, {.maxParts = 0, .maxConcavity = limit});
    expectSound(mesh, mesh.vertices, d);
    EXPECT_LE(d.parts.size(), parts) << name;
    const std::vector<Vec3> points = test::transferred(d, mesh.vertices);
    for (const Part& part : d.parts) {
      EXPECT_LE(partConcavity(partHull(part, points), points, part.triangles, limit), 1.01 * limit) << name;
    }
  }
}

/// A tube of 1 m radius and 4 m height, its wall 0.1 m thick.
TriMesh makeTube(int sides) {
  TriMesh tube;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * M_PI * i / sides;
    for (const double radius : {1.0, 0.9}) {
      for (const double z : {-2.0, 2.0}) {
        tube.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
      }
    }
    // Outside, inside, top, bottom; corners are 0 outer low, 1 outer high, 2 inner low, 3 inner high.
    for (const auto& [a, b] : std::vector<std::pair<int, int>>{{0, 1}, {3, 2}, {1, 3}, {2, 0}}) {
      const int here = 4 * i, next = 4 * ((i + 1) % sides);
      tube.triangles.push_back({here + a, next + a, next + b});
      tube.triangles.push_back({here + a, next + b, here + b});
    }
  }
  return tube;
}

/// The hull of a sector of its wall adds a segment of a circle to it; nine sectors are the fewest. Cuts only across the
/// longest axis would leave rings, and halves of halves sixteen sectors.
TEST(Decompose, ATubeIsCutAlongItsAxisIntoFewSectors) {
  const TriMesh tube = makeTube(180);
  const double angle = 2.0 * M_PI / 8.6, height = 4.0;
  const double empty = height * 0.5 * 0.9 * 0.9 * (angle - std::sin(angle));
  const double limit = std::max(0.9 * (1.0 - std::cos(0.5 * angle)), emptyConcavity(empty));
  for (const DecomposePreset preset : {DecomposePreset::kFast, DecomposePreset::kQuality}) {
    const Decomposition d = decomposed(tube, {.maxParts = 0, .preset = preset, .maxConcavity = limit});
    expectSound(tube, tube.vertices, d);
    EXPECT_GE(d.parts.size(), 9u);
    EXPECT_LE(d.parts.size(), 12u);
  }
}

/// Two boxes that touch, one 20 micrometres wider: one hull would hold them, but the wall between them is half a metre
/// from it.
TEST(Decompose, MeetsAConcavityWhereSolidsTouch) {
  constexpr double kWider = 2e-5;
  const TriMesh mesh = test::joined(test::makeBox({0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}),
                                    test::makeBox({-kWider, -kWider, 1.0}, {1.0 + kWider, 1.0 + kWider, 2.0}));
  const Decomposition d = decomposed(mesh, {.maxParts = 0, .maxConcavity = 0.05});
  expectSound(mesh, mesh.vertices, d);
  EXPECT_EQ(d.parts.size(), 2u);
}

/// Two slabs that cross at 30 degrees: they have more volume than their hull, since each counts where they overlap.
/// Their wedges are no less concave for that.
TEST(Decompose, MeetsAConcavityWhereSolidsOverlap) {
  const TriMesh slab = test::makeBox({-1.0, -0.25, -1.0}, {1.0, 0.25, 1.0});
  const Quat turn(Eigen::AngleAxisd(std::numbers::pi / 6.0, Vec3::UnitZ()));
  const TriMesh mesh = test::joined(slab, test::moved(slab, [&](const Vec3& p) { return Vec3(turn * p); }));
  ASSERT_LT(convexHull(mesh.vertices).volume, signedVolume(mesh.vertices, mesh.triangles));
  const Decomposition d = decomposed(mesh, {.maxParts = 0, .maxConcavity = 0.05});
  EXPECT_EQ(d.parts.size(), 2u);  // the slabs; one before
}

/// A torus cut badly into four parts: in half, then a small slice off each half.
struct CutTorus {
  CutTorus() : mesh(test::makeTorus(1.0, 0.4, 48, 16)), context(mesh, test::poseOf(mesh)) {
    std::vector<Part> pieces = {test::wholeOf(mesh)};
    for (const Plane& plane : {Plane{Vec3::UnitX(), 0.0}, Plane{Vec3::UnitZ(), 0.9}}) {
      std::vector<Part> next;
      for (const Part& piece : pieces) {
        CutResult cut = cutPart(piece, context.points[0], plane, context.onPlane[0], context.pointCount());
        context.addCutPoints(cut.newPoints);
        next.push_back(std::move(cut.above));
        next.push_back(std::move(cut.below));
      }
      pieces = std::move(next);
    }
    for (Part& piece : pieces) parts.push_back(measure(std::move(piece), context));
  }
  TriMesh mesh;
  CutContext context;
  std::vector<Piece> parts;
};

double hullVolume(const std::vector<Piece>& parts) {
  double sum = 0.0;
  for (const Piece& part : parts) sum += part.totalHullVolume();
  return sum;
}

ImproveRound someRound() {
  SplitEffort effort;
  effort.shortlist = 2;
  effort.axisPlanes = 6;
  return {effort, 6};
}

TEST(Improve, SavesHullVolumeAndLosesNothing) {
  CutTorus torus;
  const double before = hullVolume(torus.parts);
  ASSERT_TRUE(improve(torus.parts, torus.context, someRound(), [] { return true; }));
  EXPECT_EQ(torus.parts.size(), 4u);
  EXPECT_LT(hullVolume(torus.parts), 0.95 * before);
  double volume = 0.0;
  for (const Piece& part : torus.parts) {
    volume += part.volume[0];
    EXPECT_NEAR(partHull(part.part, torus.context.points[0]).volume, part.hullVolume[0], 1e-9);
    EXPECT_TRUE(test::isClosed(part.part.triangles));
  }
  EXPECT_NEAR(volume, torus.context.meshVolume[0], 1e-9);
}

TEST(Improve, CanBeCancelled) {
  CutTorus torus;
  EXPECT_FALSE(improve(torus.parts, torus.context, someRound(), [] { return false; }));
}

TEST(Improve, WithoutPatienceOnlyExchangesAreMade) {
  CutTorus torus;
  const double before = hullVolume(torus.parts);
  ImproveRound round = someRound();
  round.patience = 0;
  ASSERT_TRUE(improve(torus.parts, torus.context, round, [] { return true; }));
  EXPECT_LT(hullVolume(torus.parts), before);
}

/// The four parts of a torus, and what may be: no limit, or a hull of at most so much volume.
struct SharedParts : CutTorus {
  SharedParts() {
    for (Piece& part : parts) shared.push_back(std::make_shared<const Piece>(std::move(part)));
  }
  bool makeFewer(double mostVolume, double patience, bool goOn = true) {
    const auto allowed = [&](const Piece& part) {
      part.excess = part.hullVolume[0] / mostVolume;
      return *part.excess <= 1.0;
    };
    return lorica::makeFewer(shared, context, someRound().effort, patience, allowed, [&] { return goOn; });
  }
  std::vector<std::shared_ptr<const Piece>> shared;
};

TEST(MakeFewer, MakesTwoOfThreeAsLongAsBothAreAllowed) {
  SharedParts torus;
  ASSERT_TRUE(torus.makeFewer(1e3, 10.0));
  EXPECT_EQ(torus.shared.size(), 2u);
  double volume = 0.0;
  for (const std::shared_ptr<const Piece>& part : torus.shared) {
    volume += part->volume[0];
    EXPECT_TRUE(test::isClosed(part->part.triangles));
  }
  EXPECT_NEAR(volume, torus.context.meshVolume[0], 1e-9);
}

TEST(MakeFewer, KeepsPartsWhereNoneIsAllowedOrPatienceIsNone) {
  for (const auto& [mostVolume, patience] : {std::pair(1e-3, 10.0), std::pair(1e3, 0.0)}) {
    SharedParts torus;
    const std::vector<std::shared_ptr<const Piece>> before = torus.shared;
    ASSERT_TRUE(torus.makeFewer(mostVolume, patience));
    EXPECT_EQ(torus.shared, before);
  }
}

/// Half a torus fits in the limit only if the plane is in the middle.
TEST(MakeFewer, MovesAPlaneThatLeavesOneHalfTooLarge) {
  SharedParts torus;
  const double half = 0.55 * convexHull(torus.mesh.vertices).volume;
  ASSERT_TRUE(torus.makeFewer(half, 10.0));
  EXPECT_LT(torus.shared.size(), 4u);
  for (const std::shared_ptr<const Piece>& part : torus.shared) EXPECT_LE(part->hullVolume[0], half);
}

TEST(MakeFewer, CanBeCancelled) {
  EXPECT_FALSE(SharedParts().makeFewer(1e3, 10.0, false));
}

/// A torus in two keyframes, the second deformed. Positions are on a coarse grid, so that they do not depend on the
/// math library.
struct Subject {
  Subject() : mesh(test::makeTorus(1.0, 0.4, 40, 20)) {
    for (Vec3& v : mesh.vertices) v = snapped(v);
    for (int k = 0; k < 2; ++k) {
      for (const Vec3& v : mesh.vertices) keyframes.push_back(snapped(v + Vec3(0.0, 0.0, k * v.x() * v.x() * 0.3)));
    }
  }
  static Vec3 snapped(const Vec3& v) {
    return {std::round(v.x() * 1024.0) / 1024.0, std::round(v.y() * 1024.0) / 1024.0,
            std::round(v.z() * 1024.0) / 1024.0};
  }
  TriMesh mesh;
  std::vector<Vec3> keyframes;
};

/// Expected hashes for every compiler, optimization level and number of threads. If the algorithm changes, update them
/// and increase kAlgorithmVersion in acd/decompose.h.
class SameEverywhere : public ::testing::TestWithParam<std::tuple<DecomposePreset, const char*>> {};

TEST_P(SameEverywhere, HashOfTheResult) {
  const Subject subject;
  const auto [preset, expected] = GetParam();
  for (const int threads : {1, 2, 3, 8}) {
    const Decomposition d = test::decomposed(subject.mesh, {subject.keyframes, countOf(subject.mesh.vertices)},
                                             {.maxParts = 7, .preset = preset, .threads = threads});
    EXPECT_EQ(hexDigits(hashOf(d)), expected) << threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(Presets, SameEverywhere,
                         ::testing::Values(std::tuple(DecomposePreset::kPaper, "c792b853036b8116"),
                                           std::tuple(DecomposePreset::kFast, "710d63a55df334b2"),
                                           std::tuple(DecomposePreset::kQuality, "d563b875ec9165c9")));

}  // namespace
}  // namespace lorica
