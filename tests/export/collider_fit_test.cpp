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
  return measureFit(figure, std::span(&collider, 1), {poses, 2}, 1);
}

TEST(ColliderFit, OfTheSkinItselfIsZero) {
  const ColliderFits fits = fitOfBox(0.0);
  EXPECT_NEAR(fits.hulls.worstOut, 0.0, 1e-9);
  EXPECT_NEAR(fits.hulls.worstStandOff, 0.0, 1e-9);
  EXPECT_NEAR(fits.hulls.shareOut, 0.0, 1e-12);
  EXPECT_NEAR(fits.hulls.volume, 0.08, 1e-12);
  EXPECT_GT(fits.capsules.meanStandOff, 0.01);
}

TEST(ColliderFit, OfALargerBoxStandsOff) {
  const ColliderFits fits = fitOfBox(0.03);
  EXPECT_EQ(fits.hulls.worstOut, 0.0);
  EXPECT_GE(fits.hulls.meanStandOff, 0.0299);
  EXPECT_LE(fits.hulls.worstStandOff, 0.03 * std::sqrt(3.0) + 1e-9);
  EXPECT_GE(fits.hulls.worstStandOff, fits.hulls.meanStandOff);
}

TEST(ColliderFit, OfASmallerBoxSticksOut) {
  const ColliderFits fits = fitOfBox(-0.02);
  EXPECT_NEAR(fits.hulls.worstOut, 0.02 * std::sqrt(3.0), 1e-9);  // the corners of the bar
  EXPECT_NEAR(fits.hulls.meanWorstOut, 0.02 * std::sqrt(3.0), 1e-9);
  EXPECT_NEAR(fits.hulls.shareOut, 1.0, 1e-12);
  EXPECT_EQ(fits.hulls.worstStandOff, 0.0);
}

}  // namespace
}  // namespace lorica
