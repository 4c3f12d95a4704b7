#include "prepare/part_hulls.h"

#include "geometry/random_numbers.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace lorica::test {
namespace {

/// Two balls far from 0, as fine as the planes of a hull are put into groups for.
PartHulls balls(const Vec3& place) {
  PartHulls hulls;
  for (const double x : {0.0, 3.0}) {
    NamedMesh& ball = hulls.objects.emplace_back(NamedMesh{"ball", makeSphere(1.0, 24, 48)});
    for (Vec3& p : ball.mesh.vertices) p += place + Vec3(x, 0, 0);
  }
  return hulls;
}

TEST(PartHulls, WhatIsFarthestOutsideAllHullsIsNamed) {
  for (const Vec3& place : {Vec3(0, 0, 0), Vec3(-1000, 500, 2000)}) {
    const PartHulls hulls = balls(place);
    std::vector<Vec3> vertices = hulls.objects[0].mesh.vertices;
    RandomNumbers random(3);
    while (vertices.size() < 3000) {
      const Vec3 p(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
      if (p.norm() < 0.98) vertices.push_back(place + p + Vec3(vertices.size() % 2 == 0 ? 0.0 : 3.0, 0, 0));
    }
    std::vector<VertexIndex> which(vertices.size());
    std::iota(which.begin(), which.end(), 0);
    EXPECT_TRUE(checkHullsHold(hulls, vertices, which).ok());
    for (const double distance : {2e-5, 0.01, 0.4}) {
      const Vec3 corner = hulls.objects[0].mesh.vertices[300] - place;
      vertices[1500] = place + (1.0 + distance) * corner;
      vertices[1600] = place + Vec3(3, 0, 0) + (1.0 + 0.9 * distance) * corner;
      const Result<void> held = checkHullsHold(hulls, vertices, which);
      ASSERT_FALSE(held.ok()) << distance;
      EXPECT_TRUE(held.error().message.starts_with("vertex 1500 ")) << held.error().message;
      double brute = 0.0;
      for (const Triangle& t : hulls.objects[0].mesh.triangles) {
        const auto at = [&](std::size_t i) -> const Vec3& { return hulls.objects[0].mesh.vertices[t[i]]; };
        const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
        brute = std::max(brute, normal.dot(vertices[1500] - at(0)));
      }
      EXPECT_NE(held.error().message.find(fmt::format("is {:g} outside all hulls", brute)), std::string::npos)
          << held.error().message << ", expected " << brute;
    }
    vertices[1500] = vertices[1600] = place;
    EXPECT_TRUE(checkHullsHold(hulls, vertices, which).ok());
    EXPECT_TRUE(checkHullsHold(hulls, vertices, {}).ok());
  }
}

}  // namespace
}  // namespace lorica::test
