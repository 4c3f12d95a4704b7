#include "collision/live/choose_cover.h"

#include "acd/decompose.h"
#include "acd/decomposition_file.h"
#include "acd/transfer.h"
#include "collision/live/attached_vertices.h"
#include "collision/live/live_body.h"
#include "geometry/random_numbers.h"
#include "skinning/humanoid/joint_limits.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/collision/parts.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

namespace lorica {
namespace {

/// A dancer with poses to choose in and held-out poses.
struct Rehearsal {
  test::Dancer dancer;
  std::vector<LiftedPoint> lifted = liftPoints(dancer.character, dancer.decomposition);
  std::vector<Affine3> sampled = poses(20, 31);
  std::vector<Affine3> heldOut = poses(10, 32);

  [[nodiscard]] BonePoseView view(const std::vector<Affine3>& poses) const {
    return {poses, dancer.character.skeleton.jointCount()};
  }
  std::vector<Affine3> poses(int count, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<Affine3> all;
    for (int p = 0; p < count; ++p) {
      dancer.dance(random, 0.5);
      all.insert(all.end(), dancer.worldFromModel.begin(), dancer.worldFromModel.end());
    }
    return all;
  }
  [[nodiscard]] Result<HullCover> choose(const CoverSettings& settings) const {
    return chooseCover(dancer.decomposition, lifted, view(sampled), view(heldOut), settings);
  }
  /// How far any point of the body is outside its part's hull in any of some poses [m].
  double farthestOut(const HullCover& cover, const std::vector<Affine3>& poses) {
    LiveBody body = LiveBody::create(dancer.decomposition, dancer.character, cover).value();
    double farthest = 0.0;
    for (int p = 0; p < view(poses).poseCount(); ++p) {
      const auto pose = view(poses).pose(p);
      body.update(pose);
      dancer.worldFromModel.assign(pose.begin(), pose.end());
      const std::vector<Vec3> points = dancer.points();
      for (std::size_t i = 0; i < body.parts().size(); ++i) {
        std::vector<Vec3> own;
        for (const PointIndex k : dancer.decomposition.parts[i].points) own.push_back(points[k]);
        farthest = std::max(farthest, largestViolation(worldHull(body.parts()[i]), own));
      }
    }
    return farthest;
  }
};

TEST(Cover, ExactKeepsAllCandidatesWhereTheyAre) {
  const Rehearsal r;
  const HullCover exact = coverExactly(r.dancer.decomposition, r.lifted);
  EXPECT_EQ(exact.tolerance, 0.0);
  EXPECT_EQ(exact.growth, 0.0);
  for (std::size_t i = 0; i < exact.points.size(); ++i) {
    const std::vector<PointIndex> candidates =
        hullCandidates(r.dancer.decomposition, r.dancer.decomposition.parts[i], r.lifted);
    ASSERT_EQ(exact.points[i].size(), candidates.size());
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      EXPECT_EQ(exact.points[i][k].point, candidates[k]);
      EXPECT_TRUE(exact.points[i][k].outward.isZero());
    }
  }
  // No tolerance and no limit request the same.
  const HullCover asked = test::valueOf(r.choose({}));
  EXPECT_EQ(asked.sampledPoses, 0);
  EXPECT_EQ(asked.points.front().size(), exact.points.front().size());
}

TEST(Cover, CoversTheBodyInSampledPosesAndReportsWhatProtrudesInOthers) {
  Rehearsal r;
  const double height = r.dancer.character.height;
  for (const CoverSettings& settings : {CoverSettings{.tolerance = 0.004}, CoverSettings{.maxHullVertices = 24},
                                        CoverSettings{.tolerance = 0.02, .maxHullVertices = 255}}) {
    SCOPED_TRACE(testing::Message() << settings.tolerance << ", " << settings.maxHullVertices);
    const HullCover cover = test::valueOf(r.choose(settings));
    EXPECT_EQ(cover.sampledPoses, 20);
    EXPECT_EQ(cover.heldOutPoses, 10);
    for (const std::vector<CoverPoint>& points : cover.points) {
      EXPECT_GE(points.size(), 4u);
      const int max = settings.maxHullVertices > 0 ? settings.maxHullVertices : 100000;
      EXPECT_LE(points.size(), static_cast<std::size_t>(max));
      for (const CoverPoint& p : points) EXPECT_LE(p.outward.norm(), cover.growth * (1.0 + 1e-12));
    }
    EXPECT_LE(cover.sampledShortfall, settings.maxHullVertices == 0 ? settings.tolerance : 0.1);
    EXPECT_LT(r.farthestOut(cover, r.sampled), 1e-6 * height);
    EXPECT_NEAR(r.farthestOut(cover, r.heldOut), cover.heldOutShortfall, 1e-6 * height);
  }
}

TEST(Cover, FewerPointsAreNeededForALooserCover) {
  const Rehearsal r;
  std::size_t before = 100000;
  for (const double tolerance : {0.002, 0.005, 0.02}) {
    const HullCover cover = test::valueOf(r.choose({.tolerance = tolerance}));
    std::size_t count = 0;
    for (const auto& points : cover.points) count += points.size();
    EXPECT_LT(count, before);
    before = count;
  }
}

TEST(Cover, IsTheSameOnAnyNumberOfThreads) {
  const Rehearsal r;
  const Result<HullCover> one = r.choose({.maxHullVertices = 16, .threads = 1});
  const Result<HullCover> three = r.choose({.maxHullVertices = 16, .threads = 3});
  ASSERT_TRUE(one.ok() && three.ok());
  for (std::size_t i = 0; i < one->points.size(); ++i) {
    ASSERT_EQ(one->points[i].size(), three->points[i].size());
    for (std::size_t k = 0; k < one->points[i].size(); ++k) {
      EXPECT_EQ(one->points[i][k].point, three->points[i][k].point);
      EXPECT_EQ(one->points[i][k].outward, three->points[i][k].outward);
    }
  }
  EXPECT_EQ(one->heldOutShortfall, three->heldOutShortfall);
}

TEST(Cover, WrongSettingsGetASentenceAndProgressCancels) {
  const Rehearsal r;
  for (const CoverSettings& wrong : {CoverSettings{.tolerance = -0.1}, CoverSettings{.maxHullVertices = 3}}) {
    EXPECT_EQ(test::errorOf(r.choose(wrong)).code, ErrorCode::kInvalidArgument);
  }
  std::atomic<int> calls = 0;
  const Result<HullCover> cancelled = r.choose({.maxHullVertices = 16, .progress = [&](int, int) {
                                                  ++calls;
                                                  return false;
                                                }});
  ASSERT_FALSE(cancelled.ok());
  EXPECT_EQ(cancelled.error().code, ErrorCode::kCancelled);
  EXPECT_GE(calls, 1);
  EXPECT_LT(calls, 8);
}

/// The mannequin with additional visible geometry: a shell one centimetre above every fifth vertex of its skin, and a
/// rod of 40 cm in its left hand.
struct Dressed {
  Character character = makeMannequin();
  int bodyVertices = static_cast<int>(character.mesh.vertices.size());
  Decomposition decomposition;
  std::vector<LiftedPoint> lifted;

  Dressed() {
    std::vector<Vec3> normals(character.mesh.vertices.size(), Vec3::Zero());
    for (const Triangle& t : character.mesh.triangles) {
      const Vec3& a = character.mesh.vertices[t[0]];
      const Vec3 normal = (character.mesh.vertices[t[1]] - a).cross(character.mesh.vertices[t[2]] - a);
      for (const VertexIndex v : t) normals[v] += normal;
    }
    for (int v = 0; v < bodyVertices; v += 5) {
      const auto i = static_cast<std::size_t>(v);
      addVertex(character.mesh.vertices[i] + 0.01 * normals[i].normalized(),
                {character.influences.begin() + character.influenceBegin[i],
                 character.influences.begin() + character.influenceBegin[i + 1]});
    }
    const JointIndex hand = character.skeleton.jointOf(HumanBone::kLeftHand);
    const Vec3 grip = character.jointFromModel[hand].inverse().translation();
    for (int k = 0; k <= 20; ++k) addVertex(grip + Vec3(0.08, 0.0, 0.02 * k), {{hand, 1.0}});
    decomposition = cutUp(character);
    lifted = liftPoints(character, decomposition);
  }

  static Decomposition cutUp(const Character& character) {
    const PoseView bindPose{character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())};
    Result<Decomposition> made = decompose(character.mesh, bindPose, {.maxParts = 12});
    LORICA_CHECK(made.ok(), "cutting the mannequin must succeed");
    return std::move(*made);
  }

  [[nodiscard]] std::vector<Affine3> randomPose(RandomNumbers& random) const {
    std::vector<Affine3> worldFromModel(static_cast<std::size_t>(character.skeleton.jointCount()));
    computeWorldFromJoint(character.skeleton, randomPoseWithinLimits(character.skeleton, random), worldFromModel);
    computeWorldFromModel(character, worldFromModel, worldFromModel);
    return worldFromModel;
  }

 private:
  void addVertex(const Vec3& at, const std::vector<Influence>& influences) {
    character.mesh.vertices.push_back(at);
    character.influences.insert(character.influences.end(), influences.begin(), influences.end());
    character.influenceBegin.push_back(static_cast<std::uint32_t>(character.influences.size()));
  }
};

const Dressed& dressed() {
  static const Dressed made;
  return made;
}

/// How far points protrude from one live part [m].
double farthestOut(const LivePart& part, std::span<const PointIndex> points, std::span<const Vec3> world) {
  std::vector<Vec3> own;
  own.reserve(points.size());
  for (const PointIndex p : points) own.push_back(part.worldFromPart.inverse() * world[p]);
  return largestViolation(part.shape, own);
}

TEST(AttachedVertices, VerticesWithoutTrianglesDoNotChangeTheCuts) {
  const Decomposition bare = Dressed::cutUp(makeMannequin());
  const Decomposition& with = dressed().decomposition;
  EXPECT_EQ(with.vertexCount, static_cast<int>(dressed().character.mesh.vertices.size()));
  EXPECT_EQ(with.splitFrom, bare.splitFrom);
  ASSERT_EQ(with.parts.size(), bare.parts.size());
  const int shift = with.vertexCount - bare.vertexCount;
  for (std::size_t i = 0; i < bare.parts.size(); ++i) {
    std::vector<Triangle> renumbered = bare.parts[i].triangles;
    for (Triangle& t : renumbered) {
      for (PointIndex& p : t) p += p >= bare.vertexCount ? shift : 0;
    }
    EXPECT_EQ(with.parts[i].triangles, renumbered) << i;
    EXPECT_EQ(with.parts[i].sourceTriangle, bare.parts[i].sourceTriangle);
  }
}

TEST(AttachedVertices, EachVertexThatNoPartHasIsInOnePart) {
  const Dressed& d = dressed();
  const std::vector<std::vector<PointIndex>> attached = attachedVerticesOf(d.decomposition, d.lifted);
  ASSERT_EQ(attached.size(), d.decomposition.parts.size());
  std::vector<PointIndex> all;
  for (const std::vector<PointIndex>& own : attached) {
    EXPECT_TRUE(std::is_sorted(own.begin(), own.end()));
    all.insert(all.end(), own.begin(), own.end());
  }
  std::sort(all.begin(), all.end());
  ASSERT_EQ(static_cast<int>(all.size()), d.decomposition.vertexCount - d.bodyVertices);
  for (std::size_t k = 0; k < all.size(); ++k) EXPECT_EQ(all[k], d.bodyVertices + static_cast<int>(k));
  // The rod belongs to parts that the hand moves.
  const JointIndex hand = d.character.skeleton.jointOf(HumanBone::kLeftHand);
  const auto byHand = [&](PointIndex p) {
    const LiftedPoint& point = d.lifted[p];
    return std::any_of(point.begin(), point.end(),
                       [&](const LiftedTerm& term) { return term.joint == hand && term.weight > 0.5; });
  };
  int partsOfRod = 0;
  for (std::size_t i = 0; i < attached.size(); ++i) {
    if (attached[i].empty() || attached[i].back() < d.decomposition.vertexCount - 21) continue;
    ++partsOfRod;
    const std::vector<PointIndex>& own = d.decomposition.parts[i].points;
    EXPECT_TRUE(std::any_of(own.begin(), own.end(), byHand)) << "part " << i;
  }
  EXPECT_GT(partsOfRod, 0);
  // A mesh whose vertices are all used has none.
  const Character bare = makeMannequin();
  const Decomposition whole = Dressed::cutUp(bare);
  for (const auto& own : attachedVerticesOf(whole, liftPoints(bare, whole))) EXPECT_TRUE(own.empty());
}

TEST(AttachedVertices, AreInTheHullsInEveryPose) {
  const Dressed& d = dressed();
  const std::vector<std::vector<PointIndex>> attached = attachedVerticesOf(d.decomposition, d.lifted);
  LiveBody body = LiveBody::create(d.decomposition, d.character).value();
  HullCover bareCover;  // without attached vertices, to see that they matter and how much larger they make the hulls
  for (const Part& part : d.decomposition.parts) {
    std::vector<CoverPoint>& points = bareCover.points.emplace_back();
    for (const PointIndex p : hullCandidates(d.decomposition, part, d.lifted)) points.push_back({p, Vec3::Zero()});
  }
  LiveBody bare = LiveBody::create(d.decomposition, d.character, bareCover).value();
  RandomNumbers random(71);
  std::vector<Vec3> points(static_cast<std::size_t>(d.decomposition.pointCount()));
  const auto posed = std::span(points).first(d.character.mesh.vertices.size());
  double farthest = 0.0, farthestOfBare = 0.0, volume = 0.0, volumeOfBare = 0.0;
  for (int pose = 0; pose < 60; ++pose) {
    const std::vector<Affine3> worldFromModel = d.randomPose(random);
    body.update(worldFromModel);
    bare.update(worldFromModel);
    skinLinearBlend(d.character, worldFromModel, posed);
    transfer(d.decomposition, posed, points);
    for (std::size_t i = 0; i < attached.size(); ++i) {
      farthest = std::max(farthest, farthestOut(body.parts()[i], attached[i], points));
      farthest = std::max(farthest, farthestOut(body.parts()[i], d.decomposition.parts[i].points, points));
      farthestOfBare = std::max(farthestOfBare, farthestOut(bare.parts()[i], attached[i], points));
      volume += body.parts()[i].shape.volume;
      volumeOfBare += bare.parts()[i].shape.volume;
    }
  }
  EXPECT_LT(farthest, 1e-6 * d.character.height);
  EXPECT_GT(farthestOfBare, 0.2);
  // A shell 1 cm thick, which is a fifth to a third of the volume, and a rod; far less than if vertices were attached
  // to a wrong part.
  EXPECT_GT(volume, 1.05 * volumeOfBare);
  EXPECT_LT(volume, 1.4 * volumeOfBare);
  std::cout << "hulls are enlarged by " << 100.0 * (volume / volumeOfBare - 1.0) << " %\n";
}

TEST(AttachedVertices, AreHeldByFewPointsInAllSampledPoses) {
  const Dressed& d = dressed();
  RandomNumbers random(72);
  std::vector<Affine3> sampled;
  for (int pose = 0; pose < 30; ++pose) {
    const std::vector<Affine3> one = d.randomPose(random);
    sampled.insert(sampled.end(), one.begin(), one.end());
  }
  const BonePoseView view{sampled, d.character.skeleton.jointCount()};
  const HullCover cover =
      test::valueOf(chooseCover(d.decomposition, d.lifted, view, {}, {.tolerance = 0.01, .maxHullVertices = 200}));
  const std::vector<std::vector<PointIndex>> attached = attachedVerticesOf(d.decomposition, d.lifted);
  LiveBody body = LiveBody::create(d.decomposition, d.character, cover).value();
  std::vector<Vec3> points(static_cast<std::size_t>(d.decomposition.pointCount()));
  const auto posed = std::span(points).first(d.character.mesh.vertices.size());
  double farthest = 0.0;
  for (int pose = 0; pose < view.poseCount(); ++pose) {
    body.update(view.pose(pose));
    skinLinearBlend(d.character, view.pose(pose), posed);
    transfer(d.decomposition, posed, points);
    for (std::size_t i = 0; i < attached.size(); ++i) {
      farthest = std::max(farthest, farthestOut(body.parts()[i], attached[i], points));
    }
  }
  EXPECT_LT(farthest, 1e-6 * d.character.height);

  // The hull cover survives a file round trip.
  const test::TemporaryFolder folder;
  DecompositionFile content;
  content.decomposition = d.decomposition;
  content.source = "dressed mannequin";
  content.meshHash = topologyHash(d.character.mesh);
  content.errorPerKeyframe = {0.0};
  content.cover = cover;
  const Result<void> written = writeDecomposition(folder.path() / "dressed.lorica", content);
  ASSERT_TRUE(written.ok()) << written.error().message;
  const Result<DecompositionFile> read = readDecomposition(folder.path() / "dressed.lorica");
  ASSERT_TRUE(read.ok() && read->cover);
  for (std::size_t i = 0; i < cover.points.size(); ++i) {
    ASSERT_EQ(read->cover->points[i].size(), cover.points[i].size());
    for (std::size_t k = 0; k < cover.points[i].size(); ++k) {
      EXPECT_EQ(read->cover->points[i][k].point, cover.points[i][k].point);
      EXPECT_EQ(read->cover->points[i][k].outward, cover.points[i][k].outward);
    }
  }
}

}  // namespace
}  // namespace lorica
