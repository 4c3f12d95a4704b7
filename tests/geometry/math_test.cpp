#include "geometry/math.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lorica {
namespace {

TEST(Aabb, IsEmptyUntilAPointIsAdded) {
  Aabb box;
  EXPECT_TRUE(box.empty());
  EXPECT_EQ(box.diagonal(), 0.0);
  box.extend(Vec3(1, 2, 3));
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.diagonal(), 0.0);
  EXPECT_EQ(box.center(), Vec3(1, 2, 3));
}

TEST(Aabb, HoldsTheMinAndMaxOfEachAxis) {
  const std::vector<Vec3> points = {{1, -2, 3}, {-1, 5, 0}, {0, 0, -6}};
  const Aabb box = boundsOf(points);
  EXPECT_EQ(box.min, Vec3(-1, -2, -6));
  EXPECT_EQ(box.max, Vec3(1, 5, 3));
  EXPECT_EQ(box.center(), Vec3(0, 1.5, -1.5));
  EXPECT_DOUBLE_EQ(box.diagonal(), Vec3(2, 7, 9).norm());
  EXPECT_TRUE(boundsOf({}).empty());
}

TEST(RotationBetween, TurnsOneDirectionOntoTheOtherByTheShortestWay) {
  const Vec3 from(0.3, -2.0, 0.7);
  for (const Vec3& to : {Vec3(1, 0, 0), Vec3(0.3, -2.0, 0.7), Vec3(-0.3, 2.0, -0.7), Vec3(5, 5, -1)}) {
    const Quat turn = rotationBetween(from, to);
    EXPECT_NEAR((turn * from.normalized() - to.normalized()).norm(), 0.0, 1e-12) << to.transpose();
    const double angle = std::acos(std::clamp(from.normalized().dot(to.normalized()), -1.0, 1.0));
    EXPECT_NEAR(Quat::Identity().angularDistance(turn), angle, 1e-7) << to.transpose();
    const Eigen::Quaternionf single = rotationBetween(Vec3f(from.cast<float>()), Vec3f(to.cast<float>()));
    EXPECT_NEAR((single * from.normalized().cast<float>() - to.normalized().cast<float>()).norm(), 0.0F, 1e-5F);
  }
}

TEST(SymmetricAxes, OfAMatrixMadeOfKnownOnes) {
  const Mat3 known = Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Vec3 values(-2.0, 0.5, 7.0);  // ascending
  const SymmetricAxes axes = symmetricAxes(known * values.asDiagonal() * known.transpose());
  EXPECT_NEAR((axes.values - values).norm(), 0.0, 1e-12);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::abs(axes.vectors.col(i).dot(known.col(i))), 1.0, 1e-12) << i;
  }
}

}  // namespace
}  // namespace lorica
