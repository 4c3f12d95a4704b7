#include "capture/virtual_sensor/depth_render.h"

#include "capture/virtual_sensor/virtual_sensor.h"
#include "geometry/random_numbers.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace lorica {
namespace {

constexpr DepthCamera kCamera;

std::size_t pixel(int column, int row) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(kCamera.width) + static_cast<std::size_t>(column);
}

double depthAt(const DepthRenderer& renderer, int column, int row) {
  const double inverse = renderer.inverseDepth()[pixel(column, row)];
  return inverse > 0.0 ? 1.0 / inverse : 0.0;
}

/// Two triangles that form a parallelogram, counter-clockwise as seen from the direction u x v.
TriMesh parallelogram(const Vec3& corner, const Vec3& u, const Vec3& v) {
  return {{corner, corner + u, corner + u + v, corner + v}, {{0, 1, 2}, {0, 2, 3}}};
}

/// A sphere of latitudes and longitudes with its corners on the sphere.
TriMesh sphere(const Vec3& middle, double radius, int rings, int segments) {
  TriMesh mesh;
  for (int r = 0; r <= rings; ++r) {
    for (int s = 0; s < segments; ++s) {
      const double polar = M_PI * r / rings;
      const double around = 2.0 * M_PI * s / segments;
      mesh.vertices.push_back(middle + radius * Vec3(std::sin(polar) * std::sin(around), std::cos(polar),
                                                     std::sin(polar) * std::cos(around)));
    }
  }
  const auto at = [&](int r, int s) { return r * segments + s % segments; };
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < segments; ++s) {
      mesh.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      mesh.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
  }
  return mesh;
}

TEST(DepthRenderer, NothingIsSeenWhereNothingWasDrawn) {
  DepthRenderer renderer{kCamera};
  renderer.draw({}, {}, SurfaceSides::kBoth, 1);
  for (const float inverse : renderer.inverseDepth()) ASSERT_EQ(inverse, 0.0F);
  for (const std::uint8_t label : renderer.labels()) ASSERT_EQ(label, 0);
}

TEST(DepthRenderer, ATiltedSquareIsSeenWhereRaysMeetIt) {
  const Vec3 corner(-0.6, -0.5, -2.0);
  const Vec3 u(1.1, 0.2, -0.7);
  const Vec3 v(0.1, 1.2, 0.3);
  const TriMesh square = parallelogram(corner, u, v);
  DepthRenderer renderer{kCamera};
  renderer.draw(square.vertices, square.triangles, SurfaceSides::kOuter, 7);
  Mat3 basis;
  int inside = 0;
  for (int row = 0; row < kCamera.height; ++row) {
    for (int column = 0; column < kCamera.width; ++column) {
      // corner + s u + t v = depth * ray.
      basis << u, v, -kCamera.positionOf(column, row, 1.0);
      const Vec3 hit = basis.partialPivLu().solve(-corner);
      const double margin = std::min({hit.x(), hit.y(), 1.0 - hit.x(), 1.0 - hit.y()});
      if (std::abs(margin) < 1e-9) continue;
      ASSERT_NEAR(depthAt(renderer, column, row), margin > 0.0 ? hit.z() : 0.0, 2e-6) << column << ", " << row;
      ASSERT_EQ(renderer.labels()[pixel(column, row)], margin > 0.0 ? 7 : 0);
      inside += margin > 0.0 ? 1 : 0;
    }
  }
  EXPECT_GT(inside, 20000);
}

TEST(DepthRenderer, ASphereIsSeenWithinTheSagOfItsFacets) {
  const Vec3 middle(0.3, -0.2, -2.5);
  constexpr double kRadius = 0.5;
  const TriMesh mesh = sphere(middle, kRadius, 96, 192);
  DepthRenderer renderer{kCamera};
  renderer.draw(mesh.vertices, mesh.triangles, SurfaceSides::kOuter, 1);
  const double sag = kRadius * (1.0 - std::pow(std::cos(M_PI / 192), 2));
  int seen = 0;
  for (int row = 0; row < kCamera.height; ++row) {
    for (int column = 0; column < kCamera.width; ++column) {
      const Vec3 ray = kCamera.positionOf(column, row, 1.0);
      const double along = ray.dot(middle) / ray.squaredNorm();
      const double inside = kRadius * kRadius - (middle - along * ray).squaredNorm();
      if (inside < 0.0) {
        ASSERT_EQ(depthAt(renderer, column, row), 0.0);
      } else if (inside > 0.05) {
        const double depth = along - std::sqrt(inside / ray.squaredNorm());
        ASSERT_GE(depthAt(renderer, column, row), depth - 2e-6);
        ASSERT_LE(depthAt(renderer, column, row), depth + sag * kRadius / std::sqrt(inside) + 2e-6);
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 20000);
}

TEST(DepthRenderer, NeighbouringTrianglesLeaveNoGap) {
  // A plane divided into random triangles with shared corners: the fan of each random point in a jittered grid.
  RandomNumbers numbers(11);
  constexpr int kCells = 40;
  TriMesh mesh;
  for (int y = 0; y <= kCells; ++y) {
    for (int x = 0; x <= kCells; ++x) {
      const Vec3 jitter(numbers.between(-0.02, 0.02), numbers.between(-0.02, 0.02), numbers.between(-0.02, 0.02));
      mesh.vertices.push_back(Vec3(-2.0 + 0.1 * x, -2.0 + 0.1 * y, -2.0) + jitter);
    }
  }
  for (int y = 0; y < kCells; ++y) {
    for (int x = 0; x < kCells; ++x) {
      const int a = y * (kCells + 1) + x;
      mesh.triangles.push_back({a, a + 1, a + kCells + 2});
      mesh.triangles.push_back({a + kCells + 2, a + kCells + 1, a});
    }
  }
  DepthRenderer renderer{kCamera};
  renderer.draw(mesh.vertices, mesh.triangles, SurfaceSides::kOuter, 1);
  for (const float inverse : renderer.inverseDepth()) {
    ASSERT_GT(inverse, 1.0F / 2.03F);
    ASSERT_LT(inverse, 1.0F / 1.97F);
  }
}

TEST(DepthRenderer, TheNearerSurfaceWinsInAnyOrder) {
  const TriMesh near = parallelogram({-0.5, -0.5, -1.0}, Vec3::UnitX(), Vec3::UnitY());
  const TriMesh far = parallelogram({-1.0, -1.0, -3.0}, 2.0 * Vec3::UnitX(), 2.0 * Vec3::UnitY());
  DepthRenderer one{kCamera};
  one.draw(near.vertices, near.triangles, SurfaceSides::kOuter, 1);
  one.draw(far.vertices, far.triangles, SurfaceSides::kOuter, 2);
  DepthRenderer other{kCamera};
  other.draw(far.vertices, far.triangles, SurfaceSides::kOuter, 2);
  other.draw(near.vertices, near.triangles, SurfaceSides::kOuter, 1);
  EXPECT_TRUE(std::equal(one.labels().begin(), one.labels().end(), other.labels().begin()));
  EXPECT_EQ(one.labels()[pixel(320, 240)], 1);
  EXPECT_NEAR(depthAt(one, 320, 240), 1.0, 1e-6);
}

TEST(DepthRenderer, OnlyTheOuterSideOfAClosedSurfaceIsDrawn) {
  const TriMesh away = parallelogram({-0.5, -0.5, -1.0}, Vec3::UnitY(), Vec3::UnitX());
  DepthRenderer renderer{kCamera};
  renderer.draw(away.vertices, away.triangles, SurfaceSides::kOuter, 1);
  EXPECT_EQ(depthAt(renderer, 320, 240), 0.0);
  renderer.draw(away.vertices, away.triangles, SurfaceSides::kBoth, 1);
  EXPECT_NEAR(depthAt(renderer, 320, 240), 1.0, 1e-6);
}

TEST(DepthRenderer, WhatReachesBehindTheCameraIsCutAway) {
  // A floor of two triangles that extends behind the camera looks like the floor as a plane.
  const TriMesh floor = parallelogram({-50.0, -1.1, 50.0}, {100.0, 0.0, 0.0}, {0.0, 0.0, -100.0});
  DepthRenderer cut{kCamera};
  cut.draw(floor.vertices, floor.triangles, SurfaceSides::kOuter, 1);
  DepthRenderer plane{kCamera};
  plane.drawPlane(Vec3::UnitY(), -1.1, 1);
  int compared = 0;
  for (int row = 0; row < kCamera.height; ++row) {
    for (int column = 0; column < kCamera.width; ++column) {
      const double expected = depthAt(plane, column, row);
      if (expected == 0.0 || expected > 40.0) continue;
      ASSERT_NEAR(depthAt(cut, column, row), expected, 2e-6 * expected * expected);
      ++compared;
    }
  }
  EXPECT_GT(compared, 100000);
}

TEST(DepthRenderer, TrianglesThatAreNoneDrawNothingAndCrashNothing) {
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vec3> positions = {{0, 0, -1},   {1, 0, -1},          {2, 0, -1},     {nan, 0, -1},
                                       {0, inf, -1}, {0, 0, -inf},        {0, 0, 0},      {0, 0, -1e300},
                                       {0, 0, 5},    {1e300, -1e300, -1}, {0, 1e-300, -1}};
  std::vector<Triangle> triangles;
  const int count = static_cast<int>(positions.size());
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < count; ++b) {
      for (int c = 0; c < count; ++c) triangles.push_back({a, b, c});
    }
  }
  DepthRenderer renderer{kCamera};
  renderer.draw(positions, triangles, SurfaceSides::kBoth, 1);
  for (const float inverse : renderer.inverseDepth()) {
    ASSERT_TRUE(std::isfinite(inverse));
    ASSERT_LE(inverse, 20.0F);
  }
}

TEST(DepthRenderer, DrawingAgainAllocatesNothing) {
  const TriMesh mesh = sphere({0.0, 0.0, -2.0}, 0.5, 20, 20);
  DepthRenderer renderer{kCamera};
  renderer.draw(mesh.vertices, mesh.triangles, SurfaceSides::kOuter, 1);
  const long before = test::allocationCount();
  renderer.clear();
  drawRoom({}, renderer);
  renderer.draw(mesh.vertices, mesh.triangles, SurfaceSides::kOuter, 1);
  EXPECT_EQ(test::allocationCount(), before);
}

TEST(VirtualRoom, FloorWallAndBoxAreSeenWhereTheyAre) {
  VirtualRoom room;
  room.worldFromCamera = worldFromCameraAt({0.2, 1.3, 2.5}, 0.2, 0.15);
  room.boxes = {{Vec3(-0.3, 0.0, -0.5), Vec3(0.3, 0.5, 0.1)}};
  DepthRenderer renderer{kCamera};
  drawRoom(room, renderer);
  int onFloor = 0, onWall = 0, onBox = 0;
  for (int row = 0; row < kCamera.height; ++row) {
    for (int column = 0; column < kCamera.width; ++column) {
      const double depth = depthAt(renderer, column, row);
      ASSERT_GT(depth, 0.0);
      const Vec3 position = room.worldFromCamera * kCamera.positionOf(column, row, depth);
      const Aabb& box = room.boxes[0];
      const double outside = (box.min - position).cwiseMax(position - box.max).maxCoeff();
      if (std::abs(outside) < 1e-5) {
        ++onBox;
      } else if (std::abs(position.y()) < 1e-5) {
        ++onFloor;
      } else {
        ASSERT_NEAR(position.z(), *room.wall, 1e-5);
        ++onWall;
      }
    }
  }
  EXPECT_GT(onFloor, 50000);
  EXPECT_GT(onWall, 50000);
  EXPECT_GT(onBox, 5000);
}

TEST(VirtualRoom, ACameraTiltedDownSeesTheFloorInTheMiddle) {
  const Isometry3 worldFromCamera = worldFromCameraAt({1.0, 1.0, 0.0}, M_PI / 4);
  const Vec3 middle = worldFromCamera * Vec3(0.0, 0.0, -std::sqrt(2.0));
  EXPECT_NEAR((middle - Vec3(1.0, 0.0, -1.0)).norm(), 0.0, 1e-12);
  const Isometry3 toTheLeft = worldFromCameraAt(Vec3::Zero(), 0.0, M_PI / 2);
  EXPECT_NEAR((toTheLeft * Vec3(0.0, 0.0, -1.0) - Vec3(-1.0, 0.0, 0.0)).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace lorica
