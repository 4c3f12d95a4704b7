#include "collision/world/resolve_overlaps.h"
#include "collision/world/world.h"
#include "tests/collision/parts.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace lorica {
namespace {

using test::at;
using test::makeBoxPart;

Prop boxAt(const Vec3& position, double half, double angle = 0.0) {
  Prop prop;
  prop.halfExtents = Vec3::Constant(half);
  prop.worldFromProp = Eigen::Translation3d(position) * Eigen::AngleAxisd(angle, Vec3::UnitY());
  return prop;
}

/// Whether a prop is inside an upright box part: tests a grid of points in the prop, without separating planes.
bool isInside(const Prop& prop, const Vec3& moved, const Vec3& partAt, const Vec3& partHalf) {
  constexpr int kSteps = 12;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      for (int k = 0; k <= kSteps; ++k) {
        const Vec3 unit = Vec3(i, j, k) * (2.0 / kSteps) - Vec3::Ones();
        if (prop.shape == PropShape::kSphere && unit.norm() > 1.0) continue;
        const Vec3 position = prop.worldFromProp * Vec3(unit.cwiseProduct(prop.halfExtents)) + moved;
        if (((position - partAt).cwiseAbs().array() < partHalf.array()).all()) return true;
      }
    }
  }
  return false;
}

TEST(ResolveOverlaps, WhatIsClearStaysToTheBit) {
  const LivePart part = makeBoxPart(Vec3(0.3, 1.0, 0.3), at(0.0, 1.0, 0.0));
  const std::vector<Prop> props = {boxAt(Vec3(0.0, 0.1, 0.5), 0.1), boxAt(Vec3(0.0, 2.4, 0.0), 0.1)};
  for (const Vec3& move : resolveOverlaps(std::span(&part, 1), props)) EXPECT_TRUE(move.isZero());
  EXPECT_TRUE(resolveOverlaps({}, props)[0].isZero());
}

TEST(ResolveOverlaps, AStackGoesOutwardsAsOneAndWhatFallsGoesUp) {
  const Vec3 partAt(0.2, 1.5, 0.1), partHalf(0.6, 1.5, 0.8);
  const LivePart part = makeBoxPart(partHalf, at(partAt.x(), partAt.y(), partAt.z()));
  std::vector<Prop> props;
  for (int i = 0; i < 4; ++i) props.push_back(boxAt(Vec3(0.3, 0.1 + 0.2 * i, 0.7), 0.1, 0.05 * i));
  for (int i = 0; i < 3; ++i) {
    Prop falling = boxAt(Vec3(0.1, 2.2 + 0.4 * i, 0.0), 0.1, 0.3 * i);
    if (i % 2 == 0) falling.shape = PropShape::kSphere;
    props.push_back(falling);
  }
  const std::vector<Vec3> moves = resolveOverlaps(std::span(&part, 1), props);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(moves[i], moves[0]) << "of the stack, " << i;
  }
  for (std::size_t i = 4; i < 7; ++i) {
    EXPECT_EQ(moves[i], Vec3(0.0, moves[i].y(), 0.0));
    EXPECT_GT(moves[i].y(), 0.0) << "inside the part, whose top is at 3 m";
  }
  EXPECT_EQ(moves[0].y(), 0.0);
  EXPECT_GT(moves[0].z(), 0.2);
  EXPECT_GT(moves[0].normalized().dot(Vec3(0.1, 0.0, 0.6).normalized()), 0.999) << "away from the part's centre";
  for (std::size_t i = 0; i < props.size(); ++i) {
    EXPECT_TRUE(isInside(props[i], Vec3::Zero(), partAt, partHalf)) << i;
    EXPECT_FALSE(isInside(props[i], moves[i], partAt, partHalf)) << i;
    for (std::size_t k = 4; k < i; ++k) {
      EXPECT_GT(
          std::abs(
              (props[i].worldFromProp.translation() + moves[i] - props[k].worldFromProp.translation() - moves[k]).y()),
          0.2)
          << i << " in " << k;
    }
  }
}

TEST(ResolveOverlaps, StaticBodiesAndFlatPartsAreIgnored) {
  LivePart flat = makeBoxPart(Vec3(0.3, 1.0, 0.3), at(0.0, 1.0, 0.0));
  const std::vector<Prop> props = {boxAt(Vec3(0.0, 0.1, 0.0), 0.1)};
  EXPECT_FALSE(resolveOverlaps(std::span(&flat, 1), props)[0].isZero());
  std::vector<Prop> isStatic = props;
  isStatic[0].mass = 0.0;
  EXPECT_TRUE(resolveOverlaps(std::span(&flat, 1), isStatic)[0].isZero());
  flat.shape.triangles.clear();
  EXPECT_TRUE(resolveOverlaps(std::span(&flat, 1), props)[0].isZero());
}

TEST(ResolveOverlaps, AWorldDoesItOnceAndOnlyWhereItIsAsked) {
  LivePart part = makeBoxPart(Vec3(0.5, 1.0, 0.5), at(0.0, 1.0, 0.0));
  for (const bool asked : {false, true}) {
    World::Settings settings;
    settings.resolvesOverlaps = asked;
    World world(settings);
    world.addProp(boxAt(Vec3(0.0, 0.1, 0.4), 0.1));
    world.step({}, 0.0);
    EXPECT_NEAR(world.props()[0].worldFromProp.translation().z(), 0.4, 1e-6) << "there is no avatar yet";
    world.step(std::span(&part, 1), 1.0 / 30.0);
    EXPECT_EQ(world.contacts().empty(), asked);
    if (!asked) continue;
    EXPECT_GT(world.props()[0].worldFromProp.translation().z(), 0.6);
    EXPECT_LT(world.props()[0].velocity.norm(), 0.05) << "moved without velocity";
    // Later overlaps are not resolved in this way.
    test::moveTo(part, at(0.0, 1.0, 0.2));
    world.step(std::span(&part, 1), 0.1);
    EXPECT_FALSE(world.contacts().empty());
  }
}

}  // namespace
}  // namespace lorica
