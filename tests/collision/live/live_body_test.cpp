#include "collision/live/live_body.h"
#include "acd/transfer.h"
#include "collision/live/choose_cover.h"
#include "collision/live/moving_hull.h"
#include "geometry/threads.h"
#include "skinning/linear_blend.h"
#include "skinning/morphs/shapes.h"
#include "tests/collision/live/moving_hull_truth.h"
#include "tests/collision/parts.h"
#include "tests/support/allocations.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>

namespace lorica::test {
namespace {

// A box of 2 x 1 x 1, cut in the middle by hand:
//
//    2 ---- 9 ---- 3
//    |      |      |      behind it 6, 11, 7 and 4, 10, 5
//    0 ---- 8 ---- 1
Decomposition halvedBox() {
  Decomposition result;
  result.vertexCount = 8;
  result.triangleCount = 12;
  result.cutPoints = {{0, 1, 0.5}, {2, 3, 0.5}, {4, 5, 0.5}, {6, 7, 0.5}};
  result.splitFrom.resize(1);
  result.parts.resize(2);
  result.parts[0].points = {0, 2, 4, 6, 8, 9, 10, 11};
  result.parts[1].points = {1, 3, 5, 7, 8, 9, 10, 11};
  return result;
}

std::vector<Vec3> boxVertices() {
  return test::makeBox(Vec3::Zero(), Vec3(2.0, 1.0, 1.0)).vertices;
}

// Shapes are on a grid of about a millionth of a part's size, in steps of a power of two.
constexpr double kGrid = 2e-6;

TEST(LiveBody, FirstFrameSetsThePartsFrames) {
  LiveBody body = LiveBody::create(halvedBox()).value();
  body.update(boxVertices());
  ASSERT_EQ(body.parts().size(), 2u);
  for (int i : {0, 1}) {
    const LivePart& part = body.parts()[i];
    EXPECT_NEAR(part.shape.volume, 1.0, 1e-12);
    EXPECT_LT((part.worldFromPart.translation() - Vec3(0.5 + i, 0.5, 0.5)).norm(), 1e-12);
    EXPECT_TRUE(part.worldFromPart.linear().isIdentity(0.0));
    EXPECT_TRUE(part.previousWorldFromPart.isApprox(part.worldFromPart, 0.0));
    EXPECT_TRUE(part.reshaped);
    EXPECT_EQ(part.shape.vertices.size(), 8u);
    for (const Vec3& p : part.shape.vertices) EXPECT_LT((p.cwiseAbs() - Vec3::Constant(0.5)).norm(), 1e-12);
    EXPECT_EQ(body.candidateCount(i), 8u);
  }
}

TEST(LiveBody, RigidMotionGoesIntoTheTransformAndNothingIntoTheShape) {
  LiveBody body = LiveBody::create(halvedBox()).value();
  const std::vector<Vec3> first = boxVertices();
  body.update(first);
  const std::vector<LivePart> start(body.parts().begin(), body.parts().end());

  std::mt19937_64 random(11);
  for (int frame = 0; frame < 100; ++frame) {
    const std::vector<LivePart> before(body.parts().begin(), body.parts().end());
    const Isometry3 motion = Eigen::Translation3d(test::uniformVec3(random, -3.0, 3.0)) * test::uniformRotation(random);
    std::vector<Vec3> posed = first;
    for (Vec3& p : posed) p = motion * p;
    body.update(posed);
    for (std::size_t i = 0; i < 2; ++i) {
      const LivePart& part = body.parts()[i];
      EXPECT_LT((part.worldFromPart.matrix() - (motion * start[i].worldFromPart).matrix()).norm(), 1e-12);
      EXPECT_TRUE(part.previousWorldFromPart.isApprox(before[i].worldFromPart, 0.0));
      // The hull may list its corners in another order, so each is compared by its original point.
      ASSERT_EQ(part.shape.vertices.size(), start[i].shape.vertices.size());
      for (std::size_t v = 0; v < part.shape.vertices.size(); ++v) {
        const std::vector<VertexIndex>& names = start[i].shape.pointOfVertex;
        const auto same = std::find(names.begin(), names.end(), part.shape.pointOfVertex[v]);
        ASSERT_NE(same, names.end());
        const auto k = static_cast<std::size_t>(same - names.begin());
        EXPECT_LT((part.shape.vertices[v] - start[i].shape.vertices[k]).norm(), kGrid);
      }
    }
  }
}

/// A character whose joints hold its shapes: hulls are those of the deformed mesh, posed by its bones.
TEST(LiveBody, HullsFollowTheShapesOfACharacter) {
  const Decomposition decomposition = halvedBox();
  const TriMesh box = test::makeBox(Vec3::Zero(), Vec3(2.0, 1.0, 1.0));
  for (const int frameCount : {2, 3, 8, 33}) {
    SCOPED_TRACE(frameCount);
    std::mt19937_64 random(static_cast<unsigned>(frameCount));
    std::vector<Vec3> frames = box.vertices;
    std::vector<double> times = {0.0};
    for (int f = 1; f < frameCount; ++f) {
      times.push_back(0.1 * f);
      for (const Vec3& p : box.vertices) frames.push_back(p + test::uniformVec3(random, -0.3, 0.3));
    }
    const PlayedMesh played = playedMesh("soft box", box, frames, times).value();
    const Character& character = played.character;
    LiveBody body = LiveBody::create(decomposition, character).value();
    Pose pose = restPose(character.skeleton);
    std::vector<Affine3> bones(pose.size());
    std::vector<Vec3> posed(8), points(12);
    for (int step = 0; step < 4 * frameCount; ++step) {
      sampleClip(played.clip, 0.03 * step, pose);
      pose[0].rotation = test::uniformRotation(random);
      pose[0].translation = test::uniformVec3(random, -3.0, 3.0);
      computeWorldFromJoint(character.skeleton, pose, bones);
      computeWorldFromModel(character, bones, bones);
      const long before = allocationCount();
      body.update(bones);
      skinLinearBlend(character, bones, posed);
      EXPECT_TRUE(step == 0 || allocationCount() == before) << step;
      transfer(decomposition, posed, points);
      for (std::size_t i = 0; i < 2; ++i) {
        const ConvexHull hull = worldHull(body.parts()[i]);
        const ConvexHull truth = partHull(decomposition.parts[i], points);
        EXPECT_NEAR(body.parts()[i].shape.volume, truth.volume, 10.0 * kGrid);
        EXPECT_LT(largestViolation(hull, truth.vertices), 10.0 * kGrid);
        EXPECT_LT(largestViolation(truth, hull.vertices), 10.0 * kGrid);
      }
    }
  }
}

TEST(LiveBody, PartTimesShapeIsTheHullWhateverTheDeformation) {
  const Decomposition decomposition = halvedBox();
  LiveBody body = LiveBody::create(decomposition).value();
  body.update(boxVertices());
  std::mt19937_64 random(12);
  std::vector<Vec3> points(12);
  for (int frame = 0; frame < 50; ++frame) {
    std::vector<Vec3> posed = boxVertices();
    for (Vec3& p : posed) p += test::uniformVec3(random, -0.3, 0.3);
    body.update(posed);
    transfer(decomposition, posed, points);
    for (std::size_t i = 0; i < 2; ++i) {
      const LivePart& part = body.parts()[i];
      const ConvexHull hull = worldHull(part);
      const ConvexHull truth = partHull(decomposition.parts[i], points);
      EXPECT_NEAR(part.worldFromPart.linear().determinant(), 1.0, 1e-12);
      EXPECT_NEAR(part.shape.volume, truth.volume, kGrid);
      EXPECT_LT(largestViolation(hull, truth.vertices), kGrid);
      EXPECT_LT(largestViolation(truth, hull.vertices), kGrid);
    }
  }
}

TEST(LiveBody, AStillFrameHasNoMotion) {
  LiveBody body = LiveBody::create(halvedBox()).value();
  for (int frame = 0; frame < 3; ++frame) body.update(boxVertices());
  for (const LivePart& part : body.parts()) {
    EXPECT_LT((part.worldFromPart.matrix() - part.previousWorldFromPart.matrix()).norm(), 1e-12);
  }
}

TEST(LiveBody, AFlatPoseHasNoHullButAMotion) {
  LiveBody body = LiveBody::create(halvedBox()).value();
  body.update(boxVertices());
  std::vector<Vec3> flat = boxVertices();
  for (Vec3& p : flat) p.z() = 0.25;
  body.update(flat);
  for (const LivePart& part : body.parts()) {
    EXPECT_TRUE(part.shape.degenerate());
    EXPECT_TRUE(part.worldFromPart.matrix().allFinite());
    EXPECT_NEAR(part.worldFromPart.translation().z(), 0.25, 1e-12);
  }
  body.update(boxVertices());
  for (const LivePart& part : body.parts()) EXPECT_NEAR(part.shape.volume, 1.0, 1e-12);
}

TEST(LiveBody, ShapesFollowAMeshThatGrowsAThousandfoldAndShrinksAgain) {
  LiveBody body = LiveBody::create(halvedBox()).value();
  for (const double scale : {1.0, 1000.0, 1e-3, 0.0, 1.0}) {
    std::vector<Vec3> posed = boxVertices();
    for (Vec3& p : posed) p *= scale;
    body.update(posed);
    for (const LivePart& part : body.parts()) {
      EXPECT_EQ(part.shape.degenerate(), scale == 0.0);
      EXPECT_NEAR(part.shape.volume, std::pow(scale, 3), 1e-5 * std::pow(scale, 3));
    }
  }
}

TEST(LiveBody, OfACharacterIsTheHullOfItsSkinInEveryPose) {
  test::Dancer dancer;
  LiveBody body = LiveBody::create(dancer.decomposition, dancer.character).value();
  std::mt19937_64 random(13);
  std::size_t candidates = 0;
  std::size_t all = 0;
  for (std::size_t i = 0; i < body.parts().size(); ++i) {
    candidates += body.candidateCount(static_cast<PartIndex>(i));
    all += dancer.decomposition.parts[i].points.size();
  }
  std::cout << all << " points, of which " << candidates << " can be on a hull\n";
  EXPECT_LT(candidates, all);
  for (int frame = 0; frame < 20; ++frame) {
    dancer.dance(random, frame % 2 == 0 ? 0.3 : 1.5);
    body.update(dancer.worldFromModel);
    const std::vector<Vec3> points = dancer.points();
    for (std::size_t i = 0; i < body.parts().size(); ++i) {
      const LivePart& part = body.parts()[i];
      const ConvexHull truth = partHull(dancer.decomposition.parts[i], points);
      EXPECT_LT(largestViolation(worldHull(part), truth.vertices), 1e-6 * dancer.character.height);
      EXPECT_LT(largestViolation(truth, worldHull(part).vertices), 1e-6 * dancer.character.height);
      EXPECT_NEAR(part.shape.volume / truth.volume, 1.0, 1e-4);
    }
  }
}

TEST(LiveBody, PartsWhoseBonesMoveAsOneKeepTheirShape) {
  test::Dancer dancer;
  LiveBody body = LiveBody::create(dancer.decomposition, dancer.character).value();
  std::mt19937_64 random(14);
  dancer.dance(random, 0.5);
  body.update(dancer.worldFromModel);
  for (const LivePart& part : body.parts()) EXPECT_TRUE(part.reshaped);
  const std::vector<LivePart> before(body.parts().begin(), body.parts().end());
  const Isometry3 motion = Eigen::Translation3d(3.0, -1.0, 2.0) * test::uniformRotation(random);
  for (Affine3& m : dancer.worldFromModel) m = motion * m;
  body.update(dancer.worldFromModel);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const LivePart& part = body.parts()[i];
    EXPECT_FALSE(part.reshaped);
    EXPECT_EQ(part.shape.vertices, before[i].shape.vertices);
    // A part that is bent so far that its points hardly determine a rotation is pulled towards its last one, a billion
    // times weaker than by the points (rigid_fit.cpp).
    EXPECT_LT((part.worldFromPart.matrix() - (motion * before[i].worldFromPart).matrix()).norm(), 1e-7);
  }
}

TEST(LiveBody, BonesThatAreNotNumbersGiveNoHullsUntilTheyAreAgain) {
  test::Dancer dancer;
  LiveBody body = LiveBody::create(dancer.decomposition, dancer.character).value();
  std::mt19937_64 random(15);
  dancer.dance(random, 0.5);
  body.update(dancer.worldFromModel);
  std::vector<Affine3> broken = dancer.worldFromModel;
  for (Affine3& m : broken) m.matrix().setConstant(std::numeric_limits<double>::quiet_NaN());
  body.update(broken);
  for (const LivePart& part : body.parts()) EXPECT_TRUE(part.shape.degenerate());
  body.update(dancer.worldFromModel);
  for (const LivePart& part : body.parts()) {
    EXPECT_FALSE(part.shape.degenerate());
    EXPECT_TRUE(part.worldFromPart.matrix().allFinite());
  }
}

TEST(LiveBody, BonesFarOutOfRangeGiveNoHullsUntilTheyAreAgain) {
  test::Dancer dancer;
  LiveBody body = LiveBody::create(dancer.decomposition, dancer.character).value();
  for (const double size : {1e20, 1e40, 1e107, 1e155, 1e300}) {
    for (const int bone : {0, 1, 2}) {
      std::vector<Affine3> broken = dancer.worldFromModel;
      broken[bone].translation().setConstant(size);
      body.update(broken);
      broken[bone].linear() *= size;
      body.update(broken);
      broken[bone].translation() = dancer.worldFromModel[bone].translation();
      body.update(broken);
    }
    body.update(dancer.worldFromModel);
    for (const LivePart& part : body.parts()) {
      EXPECT_FALSE(part.shape.degenerate()) << size;
      EXPECT_TRUE(part.worldFromPart.matrix().allFinite()) << size;
    }
  }
}

TEST(LiveBody, HullsComeBackFromAfarInTheShapeInWhichTheyLeft) {
  test::Dancer dancer;
  LiveBody body = LiveBody::create(dancer.decomposition, dancer.character).value();
  body.update(dancer.worldFromModel);
  std::mt19937_64 random(17);
  dancer.dance(random, 0.5);
  std::vector<Affine3> away = dancer.worldFromModel;
  for (Affine3& m : away) m.translation().x() += 0x1p21;
  for (int frame = 0; frame < 3; ++frame) {
    body.update(away);
    for (const LivePart& part : body.parts()) EXPECT_TRUE(part.shape.degenerate());
  }
  body.update(dancer.worldFromModel);
  for (const LivePart& part : body.parts()) EXPECT_FALSE(part.shape.degenerate());
}

TEST(LiveBody, SupportIsTheFarthestPointOfTheHullWithFacesOrWithout) {
  test::Dancer dancer;
  LiveBody faces = LiveBody::create(dancer.decomposition, dancer.character).value();
  LiveBody points =
      LiveBody::create(dancer.decomposition, dancer.character, std::nullopt, LiveDetail::kSupport).value();
  std::mt19937_64 random(16);
  for (int frame = 0; frame < 5; ++frame) {
    dancer.dance(random, 1.0);
    faces.update(dancer.worldFromModel);
    points.update(dancer.worldFromModel);
    for (std::size_t i = 0; i < faces.parts().size(); ++i) {
      EXPECT_TRUE(points.parts()[i].shape.degenerate());
      EXPECT_EQ(points.parts()[i].worldFromPart.matrix(), faces.parts()[i].worldFromPart.matrix());
      const ConvexHull hull = worldHull(faces.parts()[i]);
      for (int k = 0; k < 50; ++k) {
        const Vec3 direction = test::uniformVec3(random, -1.0, 1.0);
        double farthest = -std::numeric_limits<double>::infinity();
        for (const Vec3& v : hull.vertices) farthest = std::max(farthest, direction.dot(v));
        const auto part = static_cast<PartIndex>(i);
        EXPECT_NEAR(direction.dot(points.support(part, direction)), farthest, kGrid);
        EXPECT_EQ(points.support(part, direction), faces.support(part, direction));
      }
    }
  }
}

TEST(LiveBody, BodiesOfOnePlanAndCopiesGoTheirOwnWays) {
  test::Dancer dancer;
  const auto plan = BodyPlan::create(dancer.decomposition, dancer.character).value();
  std::mt19937_64 random(18);
  const auto expectSame = [](const LiveBody& one, const LiveBody& other) {
    for (std::size_t i = 0; i < one.parts().size(); ++i) {
      const LivePart& a = one.parts()[i];
      const LivePart& b = other.parts()[i];
      EXPECT_EQ(a.worldFromPart.matrix(), b.worldFromPart.matrix());
      EXPECT_EQ(a.shape.vertices, b.shape.vertices);
      EXPECT_EQ(a.shape.pointOfVertex, b.shape.pointOfVertex);
      EXPECT_EQ(a.shape.triangles, b.shape.triangles);
      EXPECT_EQ(a.shape.volume, b.shape.volume);
      EXPECT_EQ(a.reshaped, b.reshaped);
    }
  };
  LiveBody first(plan);
  LiveBody second(plan);
  LiveBody alone = LiveBody::create(dancer.decomposition, dancer.character).value();
  for (int frame = 0; frame < 10; ++frame) {
    dancer.dance(random, 0.3);
    second.update(dancer.worldFromModel);
    dancer.dance(random, 0.3);
    first.update(dancer.worldFromModel);
    alone.update(dancer.worldFromModel);
    expectSame(first, alone);
  }
  LiveBody copy = first;
  second = first;
  EXPECT_EQ(copy.plan(), plan);
  EXPECT_EQ(copy.memory(), first.memory());
  expectSame(copy, first);
  for (int frame = 0; frame < 5; ++frame) {
    dancer.dance(random, 0.3);
    for (LiveBody* body : {&first, &copy, &second}) body->update(dancer.worldFromModel);
    expectSame(copy, first);
    expectSame(second, first);
  }
}

TEST(LiveBody, JumpsBetweenUnlikePosesLeaveSoundHullsOfAnyPoints) {
  // Regression: bodies of 128 points per part tangled their faces on such jumps.
  test::Dancer dancer;
  const HullCover exact = coverExactly(dancer.decomposition, liftPoints(dancer.character, dancer.decomposition));
  std::mt19937_64 random(17);
  for (const std::size_t max : {8u, 32u, 128u, 500u}) {
    HullCover some = exact;
    for (std::vector<CoverPoint>& points : some.points) {
      std::shuffle(points.begin(), points.end(), random);
      points.resize(std::min(points.size(), max));
      std::sort(points.begin(), points.end(),
                [](const CoverPoint& a, const CoverPoint& b) { return a.point < b.point; });
    }
    LiveBody body = LiveBody::create(dancer.decomposition, dancer.character, some).value();
    for (int frame = 0; frame < 60; ++frame) {
      dancer.dance(random, 1.5);
      body.update(dancer.worldFromModel);
      const std::vector<Vec3> all = dancer.points();
      for (std::size_t i = 0; i < body.parts().size(); ++i) {
        std::vector<Vec3> own;
        for (const CoverPoint& p : some.points[i]) own.push_back(all[p.point]);
        const ConvexHull truth = convexHull(own);
        EXPECT_NEAR(body.parts()[i].shape.volume / truth.volume, 1.0, 1e-3) << max << " points, frame " << frame;
      }
    }
  }
}

TEST(LiveBody, AnyNumberOfThreadsGivesTheSameHulls) {
  const auto trace = [] {
    test::Dancer dancer;
    LiveBody body = LiveBody::create(dancer.decomposition, dancer.character).value();
    std::mt19937_64 random(11);
    std::vector<ConvexHull> hulls;
    for (int frame = 0; frame < 10; ++frame) {
      dancer.dance(random, frame == 5 ? 1.5 : 0.05);
      body.update(dancer.worldFromModel);
      for (const LivePart& part : body.parts()) {
        double farthest = 0.0;
        for (const Vec3& v : part.shape.vertices) farthest = std::max(farthest, v.norm());
        EXPECT_DOUBLE_EQ(part.radius, farthest);
        hulls.push_back(part.shape);
      }
    }
    return hulls;
  };
  const std::vector<ConvexHull> one = withThreads(1, trace);
  for (const int threads : {2, 5}) {
    const std::vector<ConvexHull> many = withThreads(threads, trace);
    ASSERT_EQ(many.size(), one.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(many[i].vertices, one[i].vertices) << threads << " threads, hull " << i;
      EXPECT_EQ(many[i].triangles, one[i].triangles) << threads << " threads, hull " << i;
    }
  }
}

TEST(LiveBody, WhatDoesNotFitTheCharacterIsRefused) {
  const test::Dancer dancer;
  const auto whyNot = [&](const Decomposition& decomposition, std::optional<HullCover> cover = std::nullopt) {
    const Result<LiveBody> body = LiveBody::create(decomposition, dancer.character, std::move(cover));
    EXPECT_FALSE(body.ok());
    EXPECT_EQ(body.error().code, ErrorCode::kInvalidArgument);
    return body.error().message;
  };
  EXPECT_NE(whyNot(halvedBox()).find("was made from a mesh of 8 vertices"), std::string::npos) << whyNot(halvedBox());
  Decomposition broken = dancer.decomposition;
  broken.parts[1].points.clear();
  EXPECT_NE(whyNot(broken).find("part 1 of the decomposition has no points"), std::string::npos);
  broken = dancer.decomposition;
  broken.parts[0].points.back() = broken.pointCount();
  EXPECT_NE(whyNot(broken).find("part 0 of the decomposition has point"), std::string::npos);

  HullCover cover = coverExactly(dancer.decomposition, liftPoints(dancer.character, dancer.decomposition));
  cover.points.pop_back();
  EXPECT_NE(whyNot(dancer.decomposition, cover).find("the hull cover lists the points of"), std::string::npos);
  cover.points.push_back({{0, Vec3(0.0, std::nan(""), 0.0)}});
  EXPECT_NE(whyNot(dancer.decomposition, cover).find("finite displacements"), std::string::npos);
}

TEST(MovingHull, UpdatesAllocateNothing) {
  std::mt19937_64 random(3);
  std::vector<Vec3> points(300);
  for (Vec3& p : points) p = uniformVec3(random, -1.0, 1.0);
  std::vector<std::vector<PointRow>> frames;
  for (int frame = 0; frame < 40; ++frame) {
    // Small steps, then large jumps, then a flat shape, then no extent at all.
    const double size = frame < 15 ? 1e-3 : frame < 30 ? 1.0 : 0.0;
    for (Vec3& p : points) p += size * uniformVec3(random, -1.0, 1.0);
    std::vector<Vec3> posed = points;
    if (frame % 10 == 9) {
      for (Vec3& p : posed) p.z() = 0.0;
    }
    frames.push_back(aboutTheirMean(posed, 1e5));
  }

  MovingHull hull(300);
  const long before = allocationCount();
  ASSERT_GT(before, 0) << "the counter works: the setup allocated memory";
  MovingHull::Counts sum;
  for (const std::vector<PointRow>& rows : frames) {
    hull.update(rows);
    sum.turnedFaces += hull.counts().turnedFaces;
    sum.flips += hull.counts().flips;
    sum.deletions += hull.counts().deletions;
    sum.rebuilds += hull.counts().rebuilds;
    (void)hull.volume();
  }
  EXPECT_EQ(allocationCount() - before, 0);
  EXPECT_GT(sum.turnedFaces * sum.flips * sum.deletions, 0) << "every kind of repair occurred";
  EXPECT_GT(sum.rebuilds, 3);
}

TEST(LiveBody, FramesOfACharacterAllocateNothing) {
  Dancer dancer;
  std::mt19937_64 random(4);
  std::vector<std::vector<Affine3>> frames;
  for (int frame = 0; frame < 12; ++frame) {
    dancer.dance(random, frame % 3 == 0 ? 1.5 : 0.1);
    frames.push_back(dancer.worldFromModel);
  }
  for (Affine3& bone : frames[5]) bone.matrix().setConstant(std::numeric_limits<double>::quiet_NaN());
  for (Affine3& bone : frames[8]) bone.linear() *= 1e-3;
  // The first frame in which another thread helps would allocate, whichever that is.
  const long allocated = withThreads(1, [&] {
    LiveBody body = LiveBody::create(dancer.decomposition, dancer.character).value();
    LiveBody copy = body;
    LiveBody assigned(body.plan(), LiveDetail::kSupport);
    assigned = copy;
    LiveBody ofPlan(body.plan());
    const long before = allocationCount();
    for (LiveBody* one : {&body, &copy, &assigned, &ofPlan}) {
      for (const std::vector<Affine3>& frame : frames) {
        one->update(frame);
        (void)one->support(0, Vec3::UnitY());
      }
    }
    return allocationCount() - before;
  });
  EXPECT_EQ(allocated, 0);
}

}  // namespace
}  // namespace lorica::test
