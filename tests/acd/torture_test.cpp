#include "acd/decompose.h"

#include "tests/acd/parts.h"
#include "tests/support/value_of.h"

#include <cmath>

// More than a thousand hard meshes from fixed seeds. Checked for every one:
//   - decompose() succeeds, or returns an error; an error only if a keyframe is open, flat or inside out as a whole;
//   - every vertex of the surface is in a hull, in every keyframe;
//   - the parts' volumes add up to the whole, in every keyframe;
//   - every part is closed;
//   - the same hash on one thread and on three.
// For meshes that are nowhere inside out, and with a single keyframe, also: no part has a negative volume. More cannot
// be guaranteed. A part's volume is the integral of the surface's winding number over the part's side of flat cuts, so
// a part can be negative where the surface passes through itself inside out. In keyframes other than that of the cut
// the cap bends, and one half gains the volume that the other loses: the sum is correct, the signs need not be.

namespace lorica::test {
namespace {

/// Six times the volume in extended precision, to avoid rounding errors in the test.
long double sixfoldVolume(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  if (triangles.empty()) return 0.0L;
  using Vec3l = Eigen::Matrix<long double, 3, 1>;
  const Vec3l apex = points[triangles[0][0]].cast<long double>();
  long double sum = 0.0L;
  for (const Triangle& t : triangles) {
    const auto corner = [&](int i) -> Vec3l { return points[t[i]].cast<long double>() - apex; };
    sum += corner(0).dot(corner(1).cross(corner(2)));
  }
  return sum;
}

/// Distance of a point outside a hull [m], ignoring faces that are too thin to have a reliable plane.
double distanceOutside(const ConvexHull& hull, const Vec3& p, double diagonal) {
  double worst = 0.0;
  for (const Triangle& t : hull.triangles) {
    const Vec3& a = hull.vertices[t[0]];
    const Vec3 ab = hull.vertices[t[1]] - a, ac = hull.vertices[t[2]] - a, normal = ab.cross(ac);
    const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
    if (normal.norm() <= 1e-7 * diagonal * longest) continue;
    worst = std::max(worst, normal.dot(p - a) / normal.norm());
  }
  return worst;
}

void expectSound(const HardMesh& hard, const Decomposition& d, const DecomposeSettings& settings) {
  const int vertexCount = countOf(hard.mesh.vertices);
  ASSERT_EQ(d.splitFrom.size() + 1, d.parts.size());
  if (settings.maxParts > 0) {
    ASSERT_LE(d.parts.size(), static_cast<std::size_t>(settings.maxParts));
  }
  for (int i = 0; i < countOf(d.cutPoints); ++i) {
    ASSERT_LT(std::max(d.cutPoints[i].first, d.cutPoints[i].second), vertexCount + i);
    ASSERT_TRUE(d.cutPoints[i].lambda > 0.0 && d.cutPoints[i].lambda < 1.0);
  }
  for (const Part& part : d.parts) {
    ASSERT_FALSE(part.triangles.empty());
    ASSERT_EQ(part.sourceTriangle.size(), part.triangles.size());
    for (const std::int32_t source : part.sourceTriangle) {
      ASSERT_TRUE(source >= -1 && source < countOf(hard.mesh.triangles));
    }
    for (const Triangle& t : part.triangles) {
      ASSERT_TRUE(t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) << "a triangle with a repeated corner";
    }
    ASSERT_TRUE(isClosed(part.triangles));
  }

  const PoseView poses{hard.keyframes, vertexCount};
  for (int k = 0; k < poses.keyframeCount(); ++k) {
    SCOPED_TRACE(testing::Message() << "keyframe " << k);
    const std::vector<Vec3> points = test::transferred(d, poses.keyframe(k));
    const Aabb box = boundsOf(poses.keyframe(k));
    const double diagonal = box.diagonal();
    const double largest = std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());

    // Every part's points are in its hull, and every vertex belongs to a part.
    std::vector<bool> covered(vertexCount, false);
    for (const Part& part : d.parts) {
      const ConvexHull hull = partHull(part, points);
      for (const PointIndex p : part.points) {
        const double outside = distanceOutside(hull, points[p], diagonal);
        ASSERT_LE(outside, 1e-7 * diagonal + 1e-15 * largest) << "point " << p;
        if (p < d.vertexCount) covered[p] = true;
      }
    }
    for (const Triangle& t : hard.mesh.triangles) {
      for (const VertexIndex v : t) ASSERT_TRUE(covered[v]) << "vertex " << v;
    }

    // A cut point is rounded to 1e-16 of the coordinates, which moves the surface by the same distance.
    const double whole = static_cast<double>(sixfoldVolume(poses.keyframe(k), hard.mesh.triangles)) / 6.0;
    const double rounding = 1e-15 * largest * surfaceArea(poses.keyframe(k), hard.mesh.triangles);
    long double sum = 0.0L;
    for (const Part& part : d.parts) {
      const long double volume = sixfoldVolume(points, part.triangles) / 6.0L;
      sum += volume;
      // Points up to 1e-9 of the diagonal from a plane count as on it: a cap may be off the plane by this distance.
      if (hard.solid && poses.keyframeCount() == 1) {
        EXPECT_GE(static_cast<double>(volume), -1e-9 * diagonal * diagonal * diagonal - rounding);
      }
    }
    EXPECT_NEAR(static_cast<double>(sum), whole, 1e-9 * std::abs(whole) + rounding);
  }
}

/// The check that decompose() performs for every keyframe.
bool acceptable(const HardMesh& hard) {
  const PoseView poses{hard.keyframes, countOf(hard.mesh.vertices)};
  for (int k = 0; k < poses.keyframeCount(); ++k) {
    const TriMesh posed{{poses.keyframe(k).begin(), poses.keyframe(k).end()}, hard.mesh.triangles};
    if (!checkClosedTwoManifold(posed)) return false;
  }
  return true;
}

struct Family {
  const char* name;
  HardMesh (*make)(Dice&);
  std::uint64_t seed;  ///< of the first mesh, incremented for each further mesh
  int count;
  int minAccepted;  ///< minimum number of accepted meshes: a rejected family tests nothing
};

void PrintTo(const Family& family, std::ostream* out) {
  *out << family.name;
}

class Torture : public testing::TestWithParam<Family> {};

TEST_P(Torture, ComesOutWholeOrRefusedInASentence) {
  const Family& family = GetParam();
  int accepted = 0;
  for (int i = 0; i < family.count && !HasFatalFailure(); ++i) {
    const std::uint64_t seed = family.seed + static_cast<std::uint64_t>(i);
    SCOPED_TRACE(testing::Message() << "mesh " << i << ", seed " << seed);
    Dice dice(seed);
    const HardMesh hard = family.make(dice);
    DecomposeSettings settings;
    settings.maxParts = std::array<int, 6>{0, 1, 2, 4, 7, 16}[dice.whole(0, 5)];
    settings.preset = i % 8 == 3    ? DecomposePreset::kPaper
                      : i % 16 == 5 ? DecomposePreset::kQuality
                                    : DecomposePreset::kFast;
    settings.threads = 1;
    // Without a part limit it must terminate, and not by cutting off tiny pieces.
    const int tooMany = 200 + 4 * countOf(hard.mesh.triangles);
    settings.progress = [&](int partsDone, int) { return partsDone < tooMany; };
    const PoseView poses{hard.keyframes, countOf(hard.mesh.vertices)};
    const Result<Decomposition> d = decompose(hard.mesh, poses, settings);
    if (!d && d.error().code == ErrorCode::kCancelled) {
      ADD_FAILURE() << "more than " << tooMany << " parts for " << hard.mesh.triangles.size() << " triangles";
      continue;
    }
    if (!d) {
      EXPECT_EQ(d.error().code, ErrorCode::kBadMesh);
      EXPECT_GE(d.error().message.size(), 20u) << d.error().message;
      EXPECT_FALSE(acceptable(hard)) << d.error().message;
      continue;
    }
    ++accepted;
    expectSound(hard, *d, settings);
    if (i % 7 == 0) {
      settings.threads = 3;
      const Decomposition again = test::valueOf(decompose(hard.mesh, poses, settings));
      EXPECT_EQ(hashOf(*d), hashOf(again));
    }
  }
  EXPECT_GE(accepted, family.minAccepted);
}

std::string nameOfFamily(const testing::TestParamInfo<Family>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(HardMeshes, Torture,
                         testing::ValuesIn<Family>({{"CubesOnAGrid", cubesOnAGrid, 10000, 140, 140},
                                                    {"SeveralComponents", severalComponents, 20000, 70, 70},
                                                    {"NestedShells", nestedShells, 30000, 70, 70},
                                                    {"ManyHandles", manyHandles, 40000, 70, 70},
                                                    {"Slivers", slivers, 50000, 80, 70},
                                                    {"SpikesAndStars", spikes, 70000, 60, 60},
                                                    {"DuplicateAndCollinearVertices", duplicateAndCollinearVertices,
                                                     60000, 100, 100},
                                                    {"Prisms", prisms, 80000, 60, 60},
                                                    {"OverlappingShells", overlappingShells, 90000, 80, 80},
                                                    {"Crumpled", crumpled, 100000, 80, 40},
                                                    {"ExtremeSizes", extremeSizes, 110000, 60, 50},
                                                    {"FarFromTheOrigin", farFromTheOrigin, 120000, 50, 50},
                                                    {"SmoothMotion", smoothMotion, 130000, 50, 50},
                                                    {"ViolentMotion", violentMotion, 140000, 80, 30},
                                                    {"PartsThatBecomeFlat", partsThatBecomeFlat, 150000, 50, 50}}),
                         nameOfFamily);

}  // namespace
}  // namespace lorica::test
