#include "geometry/mass_properties.h"

#include "tests/support/meshes.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

MassProperties of(const TriMesh& mesh) {
  return massProperties(mesh.vertices, mesh.triangles);
}

TriMesh moved(TriMesh mesh, const Isometry3& transform) {
  for (Vec3& v : mesh.vertices) v = transform * v;
  return mesh;
}

const Isometry3 kSomewhere =
    Eigen::Translation3d(3.0, -7.0, 0.5) * Eigen::AngleAxisd(0.8, Vec3(1.0, 2.0, -0.5).normalized());

TEST(MassProperties, NothingAndFlatThingsWeighNothing) {
  EXPECT_EQ(massProperties({}, {}).volume, 0.0);
  const std::vector<Vec3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Triangle> bothSides = {{0, 1, 2}, {0, 2, 1}};
  const MassProperties flat = massProperties(corners, bothSides);
  EXPECT_EQ(flat.volume, 0.0);
  EXPECT_TRUE(flat.inertia.isZero());
}

TEST(MassProperties, ABoxHasTheInertiaOfTheBook) {
  const MassProperties box = of(test::makeBox(Vec3(1, 2, 3), Vec3(1.4, 2.6, 4)));
  const double a = 0.4, b = 0.6, c = 1.0, volume = a * b * c;
  EXPECT_NEAR(box.volume, volume, 1e-14);
  EXPECT_TRUE(box.center.isApprox(Vec3(1.2, 2.3, 3.5), 1e-14));
  const Vec3 moments = volume / 12.0 * Vec3(b * b + c * c, a * a + c * c, a * a + b * b);
  EXPECT_TRUE(box.inertia.isApprox(Mat3(moments.asDiagonal()), 1e-12)) << box.inertia;
}

TEST(MassProperties, ACornerTetrahedronHasTheIntegralsOfTheBook) {
  const MassProperties corner = of(test::makeTetrahedron());
  EXPECT_NEAR(corner.volume, 1.0 / 6.0, 1e-15);
  EXPECT_TRUE(corner.center.isApprox(Vec3::Constant(0.25), 1e-14));
  // The integral of x^2 over it is 1/60, that of x y 1/120; about the centre, each is 1/96 less.
  const double square = 1.0 / 60.0 - 1.0 / 96.0, product = 1.0 / 120.0 - 1.0 / 96.0;
  EXPECT_NEAR(corner.inertia(0, 0), 2.0 * square, 1e-15);
  EXPECT_NEAR(corner.inertia(0, 1), -product, 1e-15);
}

TEST(MassProperties, TwoBoxesAddUpByTheParallelAxes) {
  const TriMesh first = test::makeBox(Vec3(0, 0, 0), Vec3(1, 1, 1)),
                second = test::makeBox(Vec3(2, 0, 0), Vec3(3, 2, 1));
  const MassProperties both = of(test::joined(first, second));
  EXPECT_NEAR(both.volume, 3.0, 1e-14);
  Mat3 inertia = Mat3::Zero();
  for (const MassProperties& part : {of(first), of(second)}) {
    const Vec3 arm = part.center - both.center;
    inertia += part.inertia + part.volume * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
  }
  EXPECT_TRUE(both.inertia.isApprox(inertia, 1e-12));
}

TEST(MassProperties, FollowARigidMotion) {
  const TriMesh torus = test::makeTorus(1.0, 0.3, 24, 12);
  const MassProperties here = of(torus), there = of(moved(torus, kSomewhere));
  const Mat3 turn = kSomewhere.linear();
  EXPECT_NEAR(there.volume, here.volume, 1e-12);
  EXPECT_TRUE(there.center.isApprox(kSomewhere * here.center, 1e-12));
  EXPECT_TRUE(there.inertia.isApprox(turn * here.inertia * turn.transpose(), 1e-12));
}

TEST(MassProperties, PrincipalAxesGiveTheInertiaBack) {
  const MassProperties box = of(moved(test::makeBox(Vec3(-1, -2, -3), Vec3(1, 2, 3)), kSomewhere));
  const PrincipalInertia principal = principalInertia(box.inertia);
  EXPECT_NEAR(principal.axes.determinant(), 1.0, 1e-12);
  EXPECT_TRUE(
      Mat3(principal.axes * principal.moments.asDiagonal() * principal.axes.transpose()).isApprox(box.inertia, 1e-12));
  EXPECT_TRUE(principal.moments.isApprox(48.0 / 12.0 * Vec3(4.0 + 16.0, 4.0 + 36.0, 16.0 + 36.0), 1e-12));
}

}  // namespace
}  // namespace lorica
