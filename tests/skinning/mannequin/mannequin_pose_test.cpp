#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/skinning/mannequin/surface_checks.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

const Character& mannequin() {
  static const Character character = makeMannequin();
  return character;
}

std::vector<Vec3> posedWith(std::initializer_list<std::pair<HumanBone, Eigen::AngleAxisd>> turns) {
  Pose pose = restPose(mannequin().skeleton);
  for (const auto& [bone, turn] : turns) {
    pose[mannequin().skeleton.jointOf(bone)].rotation = Quat(turn);
  }
  std::vector<Affine3> world(pose.size());
  std::vector<Affine3> skin(pose.size());
  std::vector<Vec3> vertices(mannequin().mesh.vertices.size());
  computeWorldFromJoint(mannequin().skeleton, pose, world);
  computeWorldFromModel(mannequin(), world, skin);
  skinLinearBlend(mannequin(), skin, vertices);
  return vertices;
}

/// Volume beyond a plane in the bind pose: the flux of (p - o) . n n, to which the cut itself does not contribute.
double volumeBeyond(const Vec3& o, const Vec3& n) {
  double sum = 0.0;
  for (const Triangle& t : mannequin().mesh.triangles) {
    const auto at = [&](std::size_t i) -> const Vec3& { return mannequin().mesh.vertices[t[i]]; };
    const double depth = n.dot((at(0) + at(1) + at(2)) / 3.0 - o);
    if (depth > 0.0) sum += depth * 0.5 * n.dot((at(1) - at(0)).cross(at(2) - at(0)));
  }
  return sum;
}

constexpr double kQuarter = std::numbers::pi / 2.0;

TEST(MannequinPose, BentElbowKeepsTheArmsVolume) {
  const double arm = volumeBeyond({0.2, 0.0, 0.0}, Vec3::UnitX());
  ASSERT_GT(arm, 0.002);
  ASSERT_LT(arm, 0.005);
  const double before = volumeOf(mannequin().mesh.vertices, mannequin().mesh.triangles);
  const auto bent = posedWith({{HumanBone::kLeftLowerArm, Eigen::AngleAxisd(-kQuarter, Vec3::UnitY())}});
  EXPECT_LT(std::abs(volumeOf(bent, mannequin().mesh.triangles) - before), 0.06 * arm);
}

TEST(MannequinPose, BentKneeKeepsTheLegsVolume) {
  const double leg = 0.5 * volumeBeyond({0.0, 0.8, 0.0}, -Vec3::UnitY());
  ASSERT_GT(leg, 0.006);
  ASSERT_LT(leg, 0.015);
  const double before = volumeOf(mannequin().mesh.vertices, mannequin().mesh.triangles);
  const auto bent = posedWith({{HumanBone::kLeftLowerLeg, Eigen::AngleAxisd(kQuarter, Vec3::UnitX())}});
  EXPECT_LT(std::abs(volumeOf(bent, mannequin().mesh.triangles) - before), 0.06 * leg);
}

TEST(MannequinPose, LoweredArmsKeepTheBodysVolume) {
  const double before = volumeOf(mannequin().mesh.vertices, mannequin().mesh.triangles);
  const auto lowered = posedWith({{HumanBone::kLeftUpperArm, Eigen::AngleAxisd(-1.3, Vec3::UnitZ())},
                                  {HumanBone::kRightUpperArm, Eigen::AngleAxisd(1.3, Vec3::UnitZ())}});
  EXPECT_LT(std::abs(volumeOf(lowered, mannequin().mesh.triangles) - before), 0.04 * before);
}

TEST(MannequinPose, BentElbowTakesTheHandForwardAndNothingElse) {
  const auto bent = posedWith({{HumanBone::kLeftLowerArm, Eigen::AngleAxisd(-kQuarter, Vec3::UnitY())}});
  const Aabb box = boundsOf(bent);
  // The fingertips were 0.43 m beyond the elbow at x = 0.455; now they are as far in front of it.
  EXPECT_NEAR(box.max.z(), 0.41, 0.03);
  EXPECT_LT(box.max.x(), 0.52);
  for (std::size_t v = 0; v < bent.size(); ++v) {
    const Vec3& bind = mannequin().mesh.vertices[v];
    if (bind.x() > 0.2) continue;
    ASSERT_LT((bent[v] - bind).norm(), 1e-12) << "vertex " << v << " at " << bind.transpose();
  }
}

TEST(MannequinPose, FistClosesWithoutMovingThePalm) {
  const auto fist = posedWith({{HumanBone::kLeftIndexProximal, Eigen::AngleAxisd(-kQuarter, Vec3::UnitZ())},
                               {HumanBone::kLeftIndexIntermediate, Eigen::AngleAxisd(-kQuarter, Vec3::UnitZ())}});
  for (std::size_t v = 0; v < fist.size(); ++v) {
    const Vec3& bind = mannequin().mesh.vertices[v];
    const double moved = (fist[v] - bind).norm();
    if (bind.x() < 0.70) {
      ASSERT_LT(moved, 1e-12) << "vertex " << v << " at " << bind.transpose();
    }
    if (bind.x() > 0.865 && bind.z() > 0.012) {
      ASSERT_GT(moved, 0.05) << "vertex " << v << " at " << bind.transpose();
    }
  }
}

}  // namespace
}  // namespace lorica::test
