#include "acd/improve.h"

#include "tests/acd/parts.h"
#include "tests/support/meshes.h"

namespace lorica {
namespace {

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

}  // namespace
}  // namespace lorica
