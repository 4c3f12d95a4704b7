#include "collision/live_body.h"

#include "tests/collision/parts.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

namespace lorica {
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

double largestDifference(std::span<const Vec3> a, std::span<const Vec3> b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

TEST(LiveBody, FirstFrameSetsThePartsFrames) {
  LiveBody body(halvedBox());
  body.update(boxVertices());
  ASSERT_EQ(body.parts().size(), 2u);
  EXPECT_EQ(body.points().size(), 12u);
  for (int i : {0, 1}) {
    const LivePart& part = body.parts()[static_cast<std::size_t>(i)];
    EXPECT_NEAR(part.hull.volume, 1.0, 1e-12);
    EXPECT_LT((part.worldFromPart.translation() - Vec3(0.5 + i, 0.5, 0.5)).norm(), 1e-12);
    EXPECT_TRUE(part.worldFromPart.linear().isIdentity(0.0));
    EXPECT_TRUE(part.previousWorldFromPart.isApprox(part.worldFromPart, 0.0));
    EXPECT_EQ(part.residual.size(), 8u);
    for (const Vec3& p : part.residual) EXPECT_LT((p.cwiseAbs() - Vec3::Constant(0.5)).norm(), 1e-12);
  }
}

TEST(LiveBody, RigidMotionGoesIntoTheTransformAndNothingIntoTheShape) {
  LiveBody body(halvedBox());
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
      EXPECT_LT((part.worldFromPart.matrix() - (motion * start[i].worldFromPart).matrix()).norm(), 1e-7);
      EXPECT_TRUE(part.previousWorldFromPart.isApprox(before[i].worldFromPart, 0.0));
      // The hull may list its corners in another order, so each is compared by the point it came from.
      ASSERT_EQ(part.residual.size(), start[i].residual.size());
      for (std::size_t v = 0; v < part.residual.size(); ++v) {
        const auto same = std::find(start[i].hull.pointOfVertex.begin(), start[i].hull.pointOfVertex.end(),
                                    part.hull.pointOfVertex[v]);
        ASSERT_NE(same, start[i].hull.pointOfVertex.end());
        const auto k = static_cast<std::size_t>(same - start[i].hull.pointOfVertex.begin());
        EXPECT_LT((part.residual[v] - start[i].residual[k]).norm(), 1e-7);
        EXPECT_LT((part.hull.vertices[v] - motion * start[i].hull.vertices[k]).norm(), 1e-12);
      }
    }
  }
}

TEST(LiveBody, TransformTimesResidualIsTheHullWhateverTheDeformation) {
  LiveBody body(halvedBox());
  body.update(boxVertices());
  std::mt19937_64 random(12);
  for (int frame = 0; frame < 50; ++frame) {
    std::vector<Vec3> posed = boxVertices();
    for (Vec3& p : posed) p += test::uniformVec3(random, -0.3, 0.3);
    body.update(posed);
    for (const LivePart& part : body.parts()) {
      std::vector<Vec3> rebuilt = part.residual;
      for (Vec3& p : rebuilt) p = part.worldFromPart * p;
      EXPECT_LT(largestDifference(rebuilt, part.hull.vertices), 1e-12);
      EXPECT_NEAR(part.worldFromPart.linear().determinant(), 1.0, 1e-12);
      EXPECT_LT(largestViolation(part.hull, body.points().subspan(8)), 1e-9) << "cut points belong to both parts";
    }
  }
}

TEST(LiveBody, AStillFrameHasNoMotion) {
  LiveBody body(halvedBox());
  for (int frame = 0; frame < 3; ++frame) body.update(boxVertices());
  for (const LivePart& part : body.parts()) {
    EXPECT_LT((part.worldFromPart.matrix() - part.previousWorldFromPart.matrix()).norm(), 1e-12);
  }
}

TEST(LiveBody, AFlatPoseHasNoHullButAMotion) {
  LiveBody body(halvedBox());
  body.update(boxVertices());
  std::vector<Vec3> flat = boxVertices();
  for (Vec3& p : flat) p.z() = 0.25;
  body.update(flat);
  for (const LivePart& part : body.parts()) {
    EXPECT_TRUE(part.hull.degenerate());
    EXPECT_TRUE(part.worldFromPart.matrix().allFinite());
    EXPECT_NEAR(part.worldFromPart.translation().z(), 0.25, 1e-12);
  }
  body.update(boxVertices());
  for (const LivePart& part : body.parts()) EXPECT_NEAR(part.hull.volume, 1.0, 1e-12);
}

}  // namespace
}  // namespace lorica
