#include "session/scenes/demo_scene.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lorica {
namespace {

/// Half the extents of a prop's axis-aligned bounds in its current orientation.
Vec3 halfBounds(const Prop& prop) {
  if (prop.shape == PropShape::kSphere) return Vec3::Constant(prop.halfExtents.x());
  return prop.worldFromProp.linear().cwiseAbs() * prop.halfExtents;
}

bool overlaps(const Prop& prop, const Vec3& min, const Vec3& max) {
  const Vec3 center = prop.worldFromProp.translation();
  const Vec3 half = halfBounds(prop);
  return ((center + half).array() > min.array()).all() && ((center - half).array() < max.array()).all();
}

TEST(DemoScene, NothingStartsWhereThePersonStandsOrInTheFloorOrInAnotherProp) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const World world = makeDemoWorld(seed);
    EXPECT_NEAR(static_cast<double>(world.props().size()), 20.0, 4.0);
    for (std::size_t i = 0; i < world.props().size(); ++i) {
      const Prop& prop = world.props()[i];
      const Vec3 center = prop.worldFromProp.translation();
      const Vec3 half = halfBounds(prop);
      EXPECT_FALSE(overlaps(prop, Vec3(-0.45, 0.0, -0.45), Vec3(0.45, 1.9, 0.45))) << "trunk, prop " << i;
      EXPECT_FALSE(overlaps(prop, Vec3(-0.95, 1.2, -0.15), Vec3(0.95, 1.6, 0.15))) << "arms, prop " << i;
      EXPECT_GT(center.y() - half.y(), -1e-6);
      EXPECT_LT(center.y(), 7.0);
      EXPECT_LT(std::hypot(center.x(), center.z()), 1.0);
      for (std::size_t k = 0; k < i; ++k) {
        // Bounds of neighbours in a tower touch; a rounding error of a micrometre does not count as overlap.
        const Prop& other = world.props()[k];
        const Vec3 otherHalf = halfBounds(other) - Vec3::Constant(1e-6);
        const Vec3 otherCenter = other.worldFromProp.translation();
        EXPECT_FALSE(overlaps(prop, otherCenter - otherHalf, otherCenter + otherHalf)) << i << " and " << k;
      }
    }
  }
}

TEST(DemoScene, PropsSuitThePersonTheyAreMadeFor) {
  const World usual = makeDemoWorld(4), large = makeDemoWorldUnder(World::Settings().gravity, 4, 1.5);
  ASSERT_EQ(usual.props().size(), large.props().size());
  for (std::size_t i = 0; i < usual.props().size(); ++i) {
    const Prop &one = usual.props()[i], &other = large.props()[i];
    EXPECT_EQ(other.halfExtents, 1.5 * one.halfExtents);
    EXPECT_EQ(other.worldFromProp.translation(), 1.5 * one.worldFromProp.translation());
    EXPECT_NEAR(other.mass, 3.375 * one.mass, 1e-12) << "as dense";
  }
}

TEST(DemoScene, TheSameSeedGivesTheSameWorldAndAnotherGivesAnother) {
  const World a = makeDemoWorld(1), b = makeDemoWorld(1), c = makeDemoWorld(2);
  bool differs = false;
  ASSERT_EQ(a.props().size(), b.props().size());
  for (std::size_t i = 0; i < a.props().size(); ++i) {
    EXPECT_EQ(a.props()[i].worldFromProp.matrix(), b.props()[i].worldFromProp.matrix());
    EXPECT_EQ(a.props()[i].halfExtents, b.props()[i].halfExtents);
    differs = differs || a.props()[i].halfExtents != c.props()[i].halfExtents;
  }
  EXPECT_TRUE(differs);
}

TEST(DemoScene, TheTowersStandUntilTheyAreKnocked) {
  const World demo = makeDemoWorld(1);
  World world;
  for (const Prop& prop : demo.props()) {
    // Falling props start higher than 2 m.
    if (prop.worldFromProp.translation().y() < 2.0) world.addProp(prop);
  }
  ASSERT_EQ(world.props().size(), 10u);
  const std::vector<Prop> before(world.props().begin(), world.props().end());
  for (int i = 0; i < 300; ++i) world.step({}, 1.0 / 30.0);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_LT((world.props()[i].worldFromProp.translation() - before[i].worldFromProp.translation()).norm(), 0.01);
  }
}

TEST(DemoScene, EverythingIsDownAfterThreeSeconds) {
  World world = makeDemoWorld(3);
  for (int i = 0; i < 90; ++i) world.step({}, 1.0 / 30.0);
  for (const Prop& prop : world.props()) EXPECT_LT(prop.worldFromProp.translation().y(), 1.4);
}

}  // namespace
}  // namespace lorica
