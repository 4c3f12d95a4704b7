// The measured fit against boxes whose distances are known.
#include "export/collider_fit.h"

#include "tests/export/stick_figure.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

/// A figure that follows one bone, and a box around it or inside it as its collider.
ColliderFits fitOfBox(double grown) {
  Character figure = test::stickFigure();
  for (Influence& influence : figure.influences) influence.joint = 0;
  RigidCollider collider;
  collider.hull = test::makeBox(Vec3(-0.1 - grown, -grown, -0.1 - grown), Vec3(0.1 + grown, 2.0 + grown, 0.1 + grown));
  collider.volume = signedVolume(collider.hull.vertices, collider.hull.triangles);
  collider.capsule = capsuleAround(collider.hull.vertices);
  const std::vector<Affine3> poses = test::bentPoses(figure, {0.3, -0.8, 0.0});
  return measureFit(figure, std::span(&collider, 1), {poses, 2}, 1).value();
}

TEST(ColliderFit, IsZeroForTheSkinItselfAndMeasuresLargerAndSmallerBoxes) {
  const ColliderFits own = fitOfBox(0.0);
  EXPECT_NEAR(own.hulls.worstOut, 0.0, 1e-9);
  EXPECT_NEAR(own.hulls.worstStandOff, 0.0, 1e-9);
  EXPECT_NEAR(own.hulls.shareOut, 0.0, 1e-12);
  EXPECT_NEAR(own.hulls.volume, 0.08, 1e-12);
  EXPECT_GT(own.capsules.meanStandOff, 0.01);
  const ColliderFits larger = fitOfBox(0.03);
  EXPECT_EQ(larger.hulls.worstOut, 0.0);
  EXPECT_GE(larger.hulls.meanStandOff, 0.0299);
  EXPECT_LE(larger.hulls.worstStandOff, 0.03 * std::sqrt(3.0) + 1e-9);
  EXPECT_GE(larger.hulls.worstStandOff, larger.hulls.meanStandOff);
  const ColliderFits smaller = fitOfBox(-0.02);
  EXPECT_NEAR(smaller.hulls.worstOut, 0.02 * std::sqrt(3.0), 1e-9);  // the corners of the bar
  EXPECT_NEAR(smaller.hulls.meanWorstOut, 0.02 * std::sqrt(3.0), 1e-9);
  EXPECT_NEAR(smaller.hulls.shareOut, 1.0, 1e-12);
  EXPECT_EQ(smaller.hulls.worstStandOff, 0.0);
}

}  // namespace
}  // namespace lorica
