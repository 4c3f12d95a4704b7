#include "capture/virtual_sensor/virtual_body.h"

#include "capture/virtual_sensor/virtual_performer.h"
#include "geometry/tri_mesh.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace lorica {
namespace {

using B = HumanBone;

std::vector<Affine3> restOf(const Character& character) {
  std::vector<Affine3> worldFromJoint(static_cast<std::size_t>(character.skeleton.jointCount()));
  computeWorldFromJoint(character.skeleton, restPose(character.skeleton), worldFromJoint);
  return worldFromJoint;
}

Vec3 positionOf(const Character& character, B bone) {
  return restOf(character)[character.skeleton.jointOf(bone)].translation();
}

double lengthOf(const Character& character, B from, B to) {
  return (positionOf(character, from) - positionOf(character, to)).norm();
}

TEST(VirtualBody, FactorsOfOneChangeNothing) {
  const Character mannequin = makeMannequin();
  const Character same = withProportions(mannequin, {});
  for (std::size_t v = 0; v < mannequin.mesh.vertices.size(); ++v) {
    ASSERT_NEAR((mannequin.mesh.vertices[v] - same.mesh.vertices[v]).norm(), 0.0, 1e-12);
  }
  EXPECT_NEAR(same.height, mannequin.height, 1e-12);
}

TEST(VirtualBody, HeightScalesEverything) {
  const Character mannequin = makeMannequin();
  const Character taller = withProportions(mannequin, {.height = 1.1});
  EXPECT_NEAR(taller.height, 1.1 * mannequin.height, 1e-9);
  EXPECT_NEAR(signedVolume(taller.mesh.vertices, taller.mesh.triangles),
              1.331 * signedVolume(mannequin.mesh.vertices, mannequin.mesh.triangles), 1e-9);
  for (const B bone : {B::kHead, B::kLeftHand, B::kRightFoot, B::kHips}) {
    EXPECT_NEAR((positionOf(taller, bone) - 1.1 * positionOf(mannequin, bone)).norm(), 0.0, 1e-9);
  }
}

TEST(VirtualBody, GirthMovesTheSkinAndNoJoint) {
  const Character mannequin = makeMannequin();
  const Character heavier = withProportions(mannequin, {.girth = 1.3});
  for (const B bone : {B::kHead, B::kLeftHand, B::kRightFoot, B::kHips, B::kLeftUpperArm}) {
    EXPECT_NEAR((positionOf(heavier, bone) - positionOf(mannequin, bone)).norm(), 0.0, 0.003);
  }
  const double ratio = signedVolume(heavier.mesh.vertices, heavier.mesh.triangles) /
                       signedVolume(mannequin.mesh.vertices, mannequin.mesh.triangles);
  EXPECT_GT(ratio, 1.3);
  EXPECT_LT(ratio, 1.69);
}

TEST(VirtualBody, LimbsAndTrunkScaleByTheirFactors) {
  const Character mannequin = makeMannequin();
  const Character other = withProportions(mannequin, {.arms = 0.85, .legs = 1.15, .trunk = 1.1});
  for (const auto& [from, to, factor] : {std::tuple{B::kLeftUpperArm, B::kLeftLowerArm, 0.85},
                                         {B::kRightLowerArm, B::kRightHand, 0.85},
                                         {B::kLeftUpperLeg, B::kLeftLowerLeg, 1.15},
                                         {B::kRightLowerLeg, B::kRightFoot, 1.15},
                                         {B::kSpine, B::kChest, 1.1},
                                         {B::kNeck, B::kHead, 1.0},
                                         {B::kLeftFoot, B::kLeftToes, 1.0}}) {
    EXPECT_NEAR(lengthOf(other, from, to), factor * lengthOf(mannequin, from, to), 1e-9);
  }
  const auto lowest = [](const Character& c) { return boundsOf(c.mesh.vertices).min.y(); };
  EXPECT_NEAR(lowest(other), lowest(mannequin), 1e-9);
}

TEST(VirtualBody, AChangedBodyIsWholeAndItsRestPoseIsItsBindPose) {
  const Character other =
      withProportions(makeMannequin(), {.height = 0.9, .girth = 1.2, .arms = 1.1, .legs = 0.9, .trunk = 1.05});
  ASSERT_TRUE(checkCharacter(other).ok());
  EXPECT_TRUE(checkClosedTwoManifold(other.mesh).ok());
  std::vector<Affine3> worldFromModel = restOf(other);
  computeWorldFromModel(other, worldFromModel, worldFromModel);
  std::vector<Vec3> posed(other.mesh.vertices.size());
  skinLinearBlend(other, worldFromModel, posed);
  for (std::size_t v = 0; v < posed.size(); ++v) ASSERT_NEAR((posed[v] - other.mesh.vertices[v]).norm(), 0.0, 1e-9);
  EXPECT_NEAR(other.height, boundsOf(posed).max.y() - boundsOf(posed).min.y(), 1e-9);
}

}  // namespace
}  // namespace lorica
