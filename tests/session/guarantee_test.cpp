#include "acd/decompose.h"
#include "acd/transfer.h"
#include "capture/files/joint_csv.h"
#include "collision/hulls/cover_choice.h"
#include "collision/hulls/keyframes.h"
#include "collision/live/choose_cover.h"
#include "collision/live/live_body.h"
#include "session/pose_source.h"
#include "session/prepare/training_motions.h"
#include "skinning/humanoid/joint_limits.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <mutex>

namespace lorica {
namespace {

// The guarantee: in every pose, the posed surface is inside the hulls.

bool longTests() {
  return std::getenv("LORICA_LONG_TESTS") != nullptr;
}

/// Number of random poses: as stated in the documentation for long tests, otherwise few.
int poseCount() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return 1000;
#else
  return longTests() ? 100000 : 1600;
#endif
}
constexpr int kPosesAChunk = 500;
constexpr int kSteps = 10;  // from one random pose to the next

struct Subject {
  Character character = makeMannequin();
  std::vector<SkeletalMotion> motions;
  Decomposition decomposition;
  std::vector<std::vector<PointIndex>> surface;  ///< points of each part in spatial order
};

/// Points sorted by cells of 3 cm in the bind pose.
std::vector<PointIndex> sortedByPosition(std::vector<PointIndex> points, std::span<const Vec3> bind) {
  const auto cell = [&](PointIndex p) {
    const Eigen::Vector3i c = (bind[p] / 0.03).array().floor().cast<int>();
    return std::array<int, 3>{c.x(), c.y(), c.z()};
  };
  std::sort(points.begin(), points.end(),
            [&](PointIndex a, PointIndex b) { return cell(a) != cell(b) ? cell(a) < cell(b) : a < b; });
  return points;
}

/// The mannequin in 16 parts, as in the demo.
const Subject& subject() {
  static const Subject made = [] {
    Subject s;
    for (const std::string_view name : kShippedMotions) {
      s.motions.push_back(perform(s.character.skeleton, shippedFrames(name)).value());
    }
    const Result<std::vector<Vec3>> keyframes = sampleKeyframes(s.character, s.motions, 12);
    LORICA_CHECK(keyframes.ok(), "the mannequin is humanoid");
    const PoseView poses{*keyframes, static_cast<int>(s.character.mesh.vertices.size())};
    Result<Decomposition> parts = decompose(s.character.mesh, poses, {.maxParts = 16});
    LORICA_CHECK(parts.ok(), "the mannequin can be decomposed");
    s.decomposition = std::move(*parts);
    std::vector<Vec3> bind(static_cast<std::size_t>(s.decomposition.pointCount()));
    transfer(s.decomposition, s.character.mesh.vertices, bind);
    for (const Part& part : s.decomposition.parts) s.surface.push_back(sortedByPosition(part.points, bind));
    return s;
  }();
  return made;
}

/// Interpolates the angles of two poses within joint limits. The result is within limits because ranges are convex.
Pose between(const Skeleton& skeleton, const Pose& a, const Pose& b, double share) {
  Pose pose = a;
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    const std::optional<HumanBone> bone = skeleton.joint(j).bone;
    const auto i = static_cast<std::size_t>(j);
    if (!bone) continue;
    const JointRange& range = jointRange(*bone);
    const JointAngles from = anglesOf(range, a[i].rotation);
    const JointAngles to = anglesOf(range, b[i].rotation);
    pose[i].rotation =
        rotationOf(range, {from.twist + share * (to.twist - from.twist), from.first + share * (to.first - from.first),
                           from.second + share * (to.second - from.second)});
  }
  return pose;
}

/// Maximum distance of points outside a part's hull [m], and the number of points beyond a limit.
struct Outside {
  double farthest = 0.0;
  long count = 0;

  void add(const Outside& other) {
    farthest = std::max(farthest, other.farthest);
    count += other.count;
  }
};

/// Tests surface points against hulls, face by face.
class OutsideTest {
 public:
  explicit OutsideTest(int pointCount) : cornerOfPoint_(static_cast<std::size_t>(pointCount), -1) {}

  /// @param indices  of the part's points, in spatial order
  /// @param world    positions of all points [m]
  Outside operator()(const LivePart& part, std::span<const PointIndex> indices, std::span<const Vec3> world,
                     double limit) {
    const ConvexHull& shape = part.shape;
    if (shape.degenerate()) return {std::numeric_limits<double>::infinity(), static_cast<long>(indices.size())};
    Outside outside;
    gather(part, indices, world, limit, outside.farthest);
    gatherBalls();
    for (const Triangle& t : shape.triangles) {
      const Vec3& a = shape.vertices[t[0]];
      const Vec3& b = shape.vertices[t[1]];
      const Vec3& c = shape.vertices[t[2]];
      const Vec3 normal = (b - a).cross(c - a);
      // The plane of a sliver is inaccurate beyond its own extent; its neighbours bound the same region.
      const double longestSq = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
      const double lengthSq = normal.squaredNorm();
      if (lengthSq < 1e-8 * longestSq * longestSq) continue;
      const double scale = 1.0 / std::sqrt(lengthSq);
      testAgainst(scale * normal, scale * normal.dot(a));
    }
    for (const float out : out_) {
      outside.farthest = std::max(outside.farthest, static_cast<double>(out));
      if (static_cast<double>(out) > limit) ++outside.count;
    }
    return outside;
  }

 private:
  static constexpr std::size_t kBlock = 32;
  struct Ball {
    Vec3f center;
    float radius = 0.0f;
  };

  /// The points in the part's own frame, where single precision is accurate to a tenth of a micrometre. A point that is
  /// a vertex of the hull protrudes by at most its distance from that vertex; only this distance is tested.
  void gather(const LivePart& part, std::span<const PointIndex> indices, std::span<const Vec3> world, double limit,
              double& farthest) {
    const ConvexHull& shape = part.shape;
    for (std::size_t v = 0; v < shape.vertices.size(); ++v) {
      cornerOfPoint_[shape.pointOfVertex[v]] = static_cast<std::int32_t>(v);
    }
    x_.clear(), y_.clear(), z_.clear();
    const Isometry3 partFromWorld = part.worldFromPart.inverse();
    for (const PointIndex i : indices) {
      const Vec3 p = partFromWorld * world[i];
      const std::int32_t corner = cornerOfPoint_[i];
      if (corner >= 0) {
        const double apart = (p - shape.vertices[corner]).norm();
        if (apart <= limit) {
          farthest = std::max(farthest, apart);
          continue;
        }
      }
      x_.push_back(static_cast<float>(p.x()));
      y_.push_back(static_cast<float>(p.y()));
      z_.push_back(static_cast<float>(p.z()));
    }
    out_.assign(x_.size(), 0.0f);
    for (const VertexIndex p : shape.pointOfVertex) cornerOfPoint_[p] = -1;
  }

  void gatherBalls() {
    balls_.clear();
    for (std::size_t begin = 0; begin < x_.size(); begin += kBlock) {
      Eigen::AlignedBox3f box;
      const std::size_t end = std::min(x_.size(), begin + kBlock);
      for (std::size_t i = begin; i < end; ++i) box.extend(Vec3f(x_[i], y_[i], z_[i]));
      balls_.push_back({box.center(), 0.5f * box.diagonal().norm() + 1e-4f});
    }
  }

  void testAgainst(const Vec3& normal, double offset) {
    const Vec3f n = normal.cast<float>();
    const auto h = static_cast<float>(offset);
    for (std::size_t block = 0; block < balls_.size(); ++block) {
      if (n.dot(balls_[block].center) + balls_[block].radius < h) continue;  // all points are below
      const std::size_t end = std::min(x_.size(), (block + 1) * kBlock);
      for (std::size_t i = block * kBlock; i < end; ++i) {
        const float d = n.x() * x_[i] + n.y() * y_[i] + n.z() * z_[i] - h;
        out_[i] = d > out_[i] ? d : out_[i];
      }
    }
  }

  std::vector<std::int32_t> cornerOfPoint_;
  std::vector<float> x_, y_, z_, out_;
  std::vector<Ball> balls_;
};

/// Tests a body in random poses.
/// @param first  index of the first random pose
/// @param limit  points farther outside than this are counted [m]
Outside throwPoses(const LiveBody& fresh, int first, int poses, double limit) {
  const Subject& s = subject();
  const Skeleton& skeleton = s.character.skeleton;
  Outside all;
  std::mutex mutex;
  tbb::parallel_for(0, (poses + kPosesAChunk - 1) / kPosesAChunk, [&](int chunk) {
    RandomNumbers random(1000 + static_cast<std::uint64_t>(first / kPosesAChunk + chunk));
    LiveBody body = fresh;
    std::vector<Affine3> worldFromModel(static_cast<std::size_t>(skeleton.jointCount()));
    std::vector<Vec3> points(static_cast<std::size_t>(s.decomposition.pointCount()));
    OutsideTest outsideOf(s.decomposition.pointCount());
    const auto posed = std::span(points).first(s.character.mesh.vertices.size());
    Outside own;
    Pose from = randomPoseWithinLimits(skeleton, random);
    Pose to = from;
    for (int k = 0; k < kPosesAChunk; ++k) {
      if (k % kSteps == 0) {
        from = to;
        to = randomPoseWithinLimits(skeleton, random);
      }
      const Pose pose = between(skeleton, from, to, static_cast<double>(k % kSteps) / kSteps);
      if (!withinLimits(skeleton, pose)) own.count += 1000000;  // the test itself is wrong
      computeWorldFromJoint(skeleton, pose, worldFromModel);
      computeWorldFromModel(s.character, worldFromModel, worldFromModel);
      body.update(worldFromModel);
      skinLinearBlend(s.character, worldFromModel, posed);
      transfer(s.decomposition, posed, points);
      for (std::size_t i = 0; i < body.parts().size(); ++i) {
        own.add(outsideOf(body.parts()[i], s.surface[i], points, limit));
      }
    }
    const std::scoped_lock lock(mutex);
    all.add(own);
  });
  return all;
}

// All poses are split into kShares shares that can run in parallel.
class Guarantee : public testing::TestWithParam<int> {};
constexpr int kShares = 2;

TEST_P(Guarantee, ExactHullsHoldTheSurfaceInRandomPoses) {
  const Subject& s = subject();
  const LiveBody body = LiveBody::create(s.decomposition, s.character).value();
  EXPECT_EQ(body.coverage().tolerance, 0.0);
  const int poses = poseCount() / kShares;
  const Outside outside = throwPoses(body, GetParam() * poses, poses, 1e-5 * s.character.height);
  std::cout << poses << " poses, exact: " << outside.count << " points outside, by at most "
            << outside.farthest / s.character.height << " of the height\n";
  EXPECT_EQ(outside.count, 0);
  EXPECT_LT(outside.farthest, 1e-6 * s.character.height);
}

INSTANTIATE_TEST_SUITE_P(Shares, Guarantee, testing::Range(0, kShares));

/// How far the surface protrudes from a body in given poses.
Outside inPoses(LiveBody body, BonePoseView poses, double limit) {
  const Subject& s = subject();
  std::vector<Vec3> points(static_cast<std::size_t>(s.decomposition.pointCount()));
  const auto posed = std::span(points).first(s.character.mesh.vertices.size());
  OutsideTest outsideOf(s.decomposition.pointCount());
  Outside outside;
  for (int p = 0; p < poses.poseCount(); ++p) {
    body.update(poses.pose(p));
    skinLinearBlend(s.character, poses.pose(p), posed);
    transfer(s.decomposition, posed, points);
    for (std::size_t i = 0; i < body.parts().size(); ++i) {
      outside.add(outsideOf(body.parts()[i], s.surface[i], points, limit));
    }
  }
  return outside;
}

TEST(GuaranteeOfFewPoints, CoversAllSampledPosesAndReportsTheShortfallInOthers) {
  const Subject& s = subject();
  const double height = s.character.height;
  const CoverPoses poses = test::valueOf(coverPoses(s.character, s.motions));
  const std::vector<LiftedPoint> lifted = liftPoints(s.character, s.decomposition);
  for (const CoverSettings& settings : {CoverSettings{.tolerance = 0.005}, CoverSettings{.maxHullVertices = 64},
                                        CoverSettings{.maxHullVertices = 16}}) {
    SCOPED_TRACE(testing::Message() << settings.tolerance << " m, " << settings.maxHullVertices << " vertices");
    const HullCover cover =
        test::valueOf(chooseCover(s.decomposition, lifted, poses.sampledView(), poses.heldOutView(), settings));
    const LiveBody body = LiveBody::create(s.decomposition, s.character, cover).value();
    std::size_t max = 0;
    std::size_t points = 0;
    for (const std::vector<CoverPoint>& part : cover.points) {
      max = std::max(max, part.size());
      points += part.size();
    }
    if (settings.maxHullVertices > 0) {
      EXPECT_LE(max, static_cast<std::size_t>(settings.maxHullVertices));
    } else {
      EXPECT_LE(cover.sampledShortfall, settings.tolerance);
    }
    EXPECT_EQ(inPoses(body, poses.sampledView(), 1e-5 * height).count, 0);
    EXPECT_NEAR(inPoses(body, poses.heldOutView(), 1e-5 * height).farthest, cover.heldOutShortfall, 2e-6 * height);
    const Outside outside = throwPoses(body, 0, poseCount() / 20, 1e-5 * height);
    std::cout << points << " points, at most " << max << " per part: protruded by " << 1e3 * cover.sampledShortfall
              << " mm, enlarged by up to " << 1e3 * cover.growth << " mm; held out " << 1e3 * cover.heldOutShortfall
              << " mm; worst of " << poseCount() / 20 << " random poses " << 1e3 * outside.farthest << " mm\n";
  }
}

// Extends Thul et al. 2018, Fig. 9: a decomposition trained on several poses fits an unseen motion better than one
// trained on a single pose.

struct Spread {
  double mean = 0.0;
  double deviation = 0.0;
};

/// Relative volume error of a decomposition over every `stride`-th frame of posed positions.
Spread errorOver(const Decomposition& decomposition, const TriMesh& mesh, PoseView poses, int stride) {
  double sum = 0.0, sumSq = 0.0;
  int count = 0;
  for (int k = 0; k < poses.keyframeCount(); k += stride, ++count) {
    const double e = errorInPose(decomposition, mesh, poses.keyframe(k)).relative();
    sum += e;
    sumSq += e * e;
  }
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, sumSq / count - mean * mean))};
}

Decomposition sixteenParts(const TriMesh& mesh, std::span<const Vec3> keyframes) {
  const PoseView poses{keyframes, static_cast<int>(mesh.vertices.size())};
  Result<Decomposition> made = decompose(mesh, poses, {.maxParts = 16});
  LORICA_CHECK(made.ok(), "the mannequin is a closed two-manifold");
  LORICA_CHECK(made->parts.size() == 16, "a body has more than 16 concave regions");
  return std::move(made).value();
}

TEST(UnseenMotion, TwelveKeyframesFollowAMotionThatTheyNeverSawBetterThanTheFirstFrameAlone) {
  // Each motion in turn (of some, without long tests) is held out. The other five train two decompositions with default
  // settings: one with twelve frames at even intervals, one with only the first of these frames.
  const Character character = makeMannequin();
  std::vector<SkeletalMotion> motions;
  for (const std::string_view name : kShippedMotions) {
    motions.push_back(perform(character.skeleton, shippedFrames(name)).value());
  }

  double meanOfTwelve = 0.0, meanOfFirst = 0.0;
  const int step = longTests() ? 1 : 3, tried = countOf(kShippedMotions) / step;
  for (int unseen = 0; unseen < countOf(kShippedMotions); unseen += step) {
    std::vector<SkeletalMotion> training = motions;
    training.erase(training.begin() + unseen);
    const Result<std::vector<Vec3>> keyframes = sampleKeyframes(character, training, 12);
    const std::vector<Vec3> posed = poseAllFrames(character, motions[unseen]);
    ASSERT_TRUE(keyframes.ok());
    const PoseView poses{posed, static_cast<int>(character.mesh.vertices.size())};
    const Spread twelve = errorOver(sixteenParts(character.mesh, *keyframes), character.mesh, poses, 10);
    const std::span<const Vec3> firstFrame = std::span(*keyframes).first(character.mesh.vertices.size());
    const Spread first = errorOver(sixteenParts(character.mesh, firstFrame), character.mesh, poses, 10);
    std::cout << kShippedMotions[unseen] << " unseen, 16 parts, relative volume error: 12 keyframes " << twelve.mean
              << " +- " << twelve.deviation << ", first frame only " << first.mean << " +- " << first.deviation << '\n';
    EXPECT_GT(twelve.mean, 0.0) << "hulls cover the surface";
    meanOfTwelve += twelve.mean / tried;
    meanOfFirst += first.mean / tried;
  }
  std::cout << "mean: 12 keyframes " << meanOfTwelve << ", first frame only " << meanOfFirst << '\n';
  RecordProperty("meanErrorTwelveKeyframes", std::to_string(meanOfTwelve));
  RecordProperty("meanErrorFirstFrame", std::to_string(meanOfFirst));
  EXPECT_LT(meanOfTwelve, meanOfFirst);
}

}  // namespace
}  // namespace lorica
