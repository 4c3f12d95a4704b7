#include "acd/training_range.h"

#include "geometry/random_numbers.h"
#include "geometry/rigid_distance.h"
#include "tests/acd/parts.h"
#include "tests/support/allocations.h"
#include "tests/support/meshes.h"
#include "tests/support/same.h"

#include <gtest/gtest.h>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <set>

namespace lorica {
namespace {

/// A probe at each corner of a box around the origin, and some along its edges: symmetric under all reflections.
std::vector<Vec3> boxPoints(const Vec3& half) {
  std::vector<Vec3> points;
  for (const double x : {-1.0, -0.5, 0.5, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) points.emplace_back(x * half.x(), y * half.y(), z * half.z());
    }
  }
  return points;
}

/// A range with these keyframes, which have the same size and are relative to their centroid.
TrainingRange rangeOf(std::initializer_list<std::vector<Vec3>> keyframes) {
  TrainingRange range;
  range.keyframeCount = countOf(keyframes);
  for (const std::vector<Vec3>& keyframe : keyframes) {
    range.positions.insert(range.positions.end(), keyframe.begin(), keyframe.end());
  }
  for (std::size_t i = 0; i < keyframes.begin()->size(); ++i) range.probes.push_back(static_cast<PointIndex>(i));
  return range;
}

std::vector<Vec3> moved(std::vector<Vec3> points, const Isometry3& motion) {
  for (Vec3& p : points) p = motion * p;
  return points;
}

Isometry3 randomMotion(RandomNumbers& random) {
  const Eigen::Vector4d q(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
  Isometry3 motion(Quat(q.normalized()));
  motion.pretranslate(Vec3(random.between(-9, 9), random.between(-9, 9), random.between(-9, 9)));
  return motion;
}

std::vector<Vec3> randomPoints(RandomNumbers& random, std::size_t count) {
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = {random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
  Vec3 centroid = Vec3::Zero();
  for (const Vec3& p : points) centroid += p / static_cast<double>(count);
  for (Vec3& p : points) p -= centroid;
  return points;
}

/// Independent reference: the best rotation, from a singular value decomposition (Kabsch 1976), then the distances.
double distanceByKabsch(std::span<const Vec3> a, std::span<const Vec3> b) {
  Mat3 s = Mat3::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) s += b[i] * a[i].transpose();
  const Eigen::JacobiSVD<Mat3> svd(s, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 flip = Mat3::Identity();
  flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  const Mat3 rotation = svd.matrixU() * flip * svd.matrixV().transpose();
  double sumSq = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sumSq += (rotation * a[i] - b[i]).squaredNorm();
  return std::sqrt(sumSq / static_cast<double>(a.size()));
}

/// Each half of the points moved outwards along x.
std::vector<Vec3> stretched(std::vector<Vec3> points, double by) {
  for (Vec3& p : points) p.x() += p.x() > 0.0 ? by : -by;
  return points;
}

TEST(RigidDistance, EqualsWhatTheBestRotationLeaves) {
  RandomNumbers random(1);
  for (int i = 0; i < 500; ++i) {
    const std::size_t count = 1 + random.bits() % 40;
    const std::vector<Vec3> a = randomPoints(random, count);
    std::vector<Vec3> b = randomPoints(random, count);
    if (i % 2 == 0) {
      // Near each other, like poses of one body; and mirrored, where the best orthogonal map is not a rotation.
      for (std::size_t k = 0; k < count; ++k) b[k] = (a[k] + 0.1 * b[k]).cwiseProduct(Vec3(i % 4 == 0 ? -1 : 1, 1, 1));
    }
    EXPECT_NEAR(rigidDistance(a, b), distanceByKabsch(a, b), 1e-6) << i;
    EXPECT_NEAR(rigidDistance(a, b), rigidDistance(b, a), 1.1e-6) << i;
  }
}

TEST(TrainingDistance, IsZeroForAKeyframeThatMovedRigidly) {
  RandomNumbers random(2);
  const std::vector<Vec3> first = randomPoints(random, 40), second = randomPoints(random, 40);
  const TrainingRange range = rangeOf({first, second});
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(trainingDistance(range, moved(i % 2 == 0 ? first : second, randomMotion(random))), 0.0);
  }
}

TEST(TrainingDistance, IsWhatIsKnownInClosedForm) {
  const std::vector<Vec3> box = boxPoints({3.0, 2.0, 1.0});
  const TrainingRange range = rangeOf({box});
  RandomNumbers random(3);
  // Each half moved outwards by d: no rotation helps, and every probe is d away.
  EXPECT_NEAR(trainingDistance(range, moved(stretched(box, 0.25), randomMotion(random))), 0.25, 1e-6);
  // Enlarged by a tenth: a tenth of the root mean square distance from the centroid, 0.625 * 9 + 4 + 1.
  std::vector<Vec3> larger = box;
  for (Vec3& p : larger) p *= 1.1;
  EXPECT_NEAR(trainingDistance(range, moved(larger, randomMotion(random))), 0.1 * std::sqrt(10.625), 1e-6);
  // One probe of n moved by d along the line from the centroid: d sqrt(1 / n - 1 / n^2); a rotation gains nothing.
  const std::vector<Vec3> cross = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<Vec3> longer = cross;
  longer[0].x() += 0.3;
  EXPECT_NEAR(trainingDistance(rangeOf({cross}), moved(longer, randomMotion(random))), 0.3 * std::sqrt(5.0) / 6.0,
              1e-6);
}

TEST(TrainingDistance, IsToTheNearestKeyframe) {
  const std::vector<Vec3> box = boxPoints({3.0, 2.0, 1.0});
  const TrainingRange range = rangeOf({box, stretched(box, 1.0), stretched(box, 0.5)});
  for (const auto& [by, distance] : {std::pair{0.1, 0.1}, {0.4, 0.1}, {0.8, 0.2}, {1.7, 0.7}}) {
    EXPECT_NEAR(trainingDistance(range, stretched(box, by)), distance, 1e-6) << by;
  }
}

TEST(TrainingDistance, OfAPoseThatIsNotFiniteIsInfinite) {
  std::vector<Vec3> box = boxPoints({3.0, 2.0, 1.0});
  const TrainingRange range = rangeOf({box});
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    box[7].y() = bad;
    EXPECT_EQ(trainingDistance(range, box), std::numeric_limits<double>::infinity());
  }
}

TEST(TrainingDistance, AllocatesNothing) {
  RandomNumbers random(4);
  const std::vector<Vec3> pose = randomPoints(random, kMaxProbes);
  const TrainingRange range = rangeOf({randomPoints(random, kMaxProbes), randomPoints(random, kMaxProbes)});
  std::vector<Vec3> gathered(kMaxProbes);
  double distance = 0.0;
  const test::AllocationWatch watch;
  gatherProbes(range, pose, gathered);
  distance = trainingDistance(range, gathered);
  EXPECT_EQ(watch.largest(), 0u);
  EXPECT_GT(distance, 0.1);
}

/// A torus bent increasingly about the x axis: an animation of three keyframes and the poses between them.
struct BentTorus : testing::Test {
  std::vector<Vec3> frames(std::initializer_list<double> strengths) const {
    std::vector<Vec3> positions;
    for (const double strength : strengths) {
      for (const Vec3& p : torus.vertices) positions.push_back(p + Vec3(0, 0, strength * p.x() * p.x()));
    }
    return positions;
  }
  PoseView view(const std::vector<Vec3>& positions) const { return {positions, countOf(torus.vertices)}; }
  Decomposition decomposedTo(int parts) const { return test::decomposed(torus, view(keyframes), {.maxParts = parts}); }
  double distanceOf(const TrainingRange& range, const Decomposition& decomposition, double strength) const {
    return farthestFrame(range, decomposition, view(frames({strength})));
  }

  TriMesh torus = test::makeTorus(2.0, 0.5, 48, 24);
  std::vector<Vec3> keyframes = frames({0.0, 0.2, 0.4});
};

TEST_F(BentTorus, ProbesAreSpreadOverAllParts) {
  for (const int parts : {1, 3, 12, 16, 40}) {
    const Decomposition decomposition = decomposedTo(parts);
    const TrainingRange range = trainingRange(decomposition, view(keyframes));
    const std::set<PointIndex> probes(range.probes.begin(), range.probes.end());
    EXPECT_EQ(probes.size(), range.probes.size()) << "no duplicates";
    EXPECT_EQ(probes.size(), std::clamp<std::size_t>(4 * decomposition.parts.size(), 32, 128));
    EXPECT_EQ(range.keyframeCount, 3);
    EXPECT_EQ(range.positions.size(), 3 * range.probes.size());

    const std::vector<Vec3> points = test::transferred(decomposition, view(keyframes).keyframe(0));
    for (const Part& part : decomposition.parts) {
      std::vector<PointIndex> own;
      for (const PointIndex p : part.points) {
        if (probes.contains(p)) own.push_back(p);
      }
      EXPECT_GE(own.size(), 3u);
      // No point of a part is far from the part's probes.
      Aabb box;
      double worst = 0.0;
      for (const PointIndex p : part.points) {
        box.extend(points[p]);
        double nearest = std::numeric_limits<double>::infinity();
        for (const PointIndex q : own) nearest = std::min(nearest, (points[p] - points[q]).norm());
        worst = std::max(worst, nearest);
      }
      EXPECT_LT(worst, 0.6 * box.diagonal());
    }
  }
}

TEST_F(BentTorus, KeyframesAreKeptAboutTheirCentroidsAndTheGuessIsAShareOfTheirSize) {
  const Decomposition decomposition = decomposedTo(8);
  const TrainingRange range = trainingRange(decomposition, view(keyframes));
  double sumSq = 0.0;
  for (int k = 0; k < 3; ++k) {
    const std::vector<Vec3> points = test::transferred(decomposition, view(keyframes).keyframe(k));
    Vec3 centroid = Vec3::Zero();
    for (const PointIndex p : range.probes) centroid += points[p];
    centroid /= static_cast<double>(range.probes.size());
    for (std::size_t i = 0; i < range.probes.size(); ++i) {
      const Vec3 expected = points[range.probes[i]] - centroid;
      EXPECT_LT((range.keyframe(k)[i] - expected).norm(), 1e-12);
      sumSq += expected.squaredNorm();
    }
  }
  EXPECT_NEAR(range.knownDistance, 0.3 * std::sqrt(sumSq / static_cast<double>(range.positions.size())), 1e-12);
  EXPECT_EQ(farthestFrame(range, decomposition, view(keyframes)), 0.0);
}

TEST_F(BentTorus, FramesOfTheTrainingMotionAreKnownAndFartherPosesAreNot) {
  const Decomposition decomposition = decomposedTo(8);
  TrainingRange range = trainingRange(decomposition, view(keyframes));
  const std::initializer_list<double> between = {0.0, 0.03, 0.1, 0.17, 0.25, 0.3, 0.38, 0.4};
  range.knownDistance = farthestFrame(range, decomposition, view(frames(between)));
  EXPECT_GT(range.knownDistance, 0.0);
  for (const double strength : between) {
    EXPECT_LE(distanceOf(range, decomposition, strength), range.knownDistance) << strength;
  }
  // Between two keyframes the distance is largest halfway; beyond the last keyframe it increases.
  EXPECT_NEAR(distanceOf(range, decomposition, 0.1), range.knownDistance, 0.1 * range.knownDistance);
  double before = range.knownDistance;
  for (const double strength : {0.55, 0.7, 1.0, 2.0}) {
    const double distance = distanceOf(range, decomposition, strength);
    EXPECT_GT(distance, before) << strength;
    before = distance;
  }
  EXPECT_GT(distanceOf(range, decomposition, -0.3), range.knownDistance);
}

TEST_F(BentTorus, TheSameInputGivesTheSameRange) {
  const Decomposition decomposition = decomposedTo(8);
  test::expectSame(trainingRange(decomposition, view(keyframes)), trainingRange(decomposition, view(keyframes)),
                   &TrainingRange::probes, &TrainingRange::positions, &TrainingRange::knownDistance);
}

TEST(TrainingRange, AMeshOfFewPointsHasThemAllAsProbes) {
  const TriMesh mesh = test::makeLShape();
  const Decomposition decomposition = test::decomposed(mesh, {.maxParts = 1});
  TrainingRange range = trainingRange(decomposition, test::poseOf(mesh));
  std::sort(range.probes.begin(), range.probes.end());
  EXPECT_EQ(range.probes, decomposition.parts[0].points);
}

}  // namespace
}  // namespace lorica
