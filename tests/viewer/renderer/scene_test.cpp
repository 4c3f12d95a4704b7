#include "viewer/renderer/scene.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica {
namespace {

/// Linear sRGB to OKLab (B. Ottosson 2020), in which distances are perceptually uniform.
Vec3 oklab(const Vec3f& c) {
  const double l = std::cbrt(0.4122214708 * c.x() + 0.5363325363 * c.y() + 0.0514459929 * c.z());
  const double m = std::cbrt(0.2119034982 * c.x() + 0.6806995451 * c.y() + 0.1073969566 * c.z());
  const double s = std::cbrt(0.0883024619 * c.x() + 0.2817188376 * c.y() + 0.6299787005 * c.z());
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

TEST(PartColor, ThirtyTwoPartsCanBeDistinguished) {
  double nearest = 1.0;
  for (int i = 0; i < 32; ++i) {
    const Vec3f color = partColor(i);
    EXPECT_GE(color.minCoeff(), 0.0f);
    EXPECT_LE(color.maxCoeff(), 1.0f);
    for (int j = 0; j < i; ++j) nearest = std::min(nearest, (oklab(color) - oklab(partColor(j))).norm());
  }
  EXPECT_GT(nearest, 0.05);  // a just noticeable difference is about 0.02
}

TEST(PartColor, NeighboursInOrderDifferStrongly) {
  for (int i = 1; i < 64; ++i) EXPECT_GT((oklab(partColor(i)) - oklab(partColor(i - 1))).norm(), 0.12) << i;
}

TEST(PartColor, AnyIndexGivesAColor) {
  for (const int part : {-1, 1000000, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
    const Vec3f color = partColor(part);
    EXPECT_TRUE(color.allFinite());
    EXPECT_GE(color.minCoeff(), 0.0f);
    EXPECT_LE(color.maxCoeff(), 1.0f);
  }
}

}  // namespace
}  // namespace lorica
