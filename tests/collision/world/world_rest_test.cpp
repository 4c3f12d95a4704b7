#include "collision/world/world.h"
#include "tests/collision/parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

using test::at;
using test::makeBoxPart;
using test::uniform;

constexpr double kFrame = 1.0 / 30.0;
constexpr double kHalf = 0.1;  // of the boxes [m]
constexpr double kTop = 1.0;   // mean height of the table [m]

/// A table whose hull has other vertices, in another order, in every frame, like a live hull.
struct Table {
  double noise = 0.0;    ///< vertical, of each vertex [m]
  double breath = 0.0;   ///< amplitude of the top's vertical motion [m]
  double seconds = 4.0;  ///< period of that motion

  [[nodiscard]] double heightAt(double time) const {
    return kTop + breath * std::sin(2.0 * std::numbers::pi * time / seconds);
  }
  [[nodiscard]] std::vector<Vec3> cornersAt(double time, std::mt19937_64& random) const {
    std::vector<Vec3> corners;
    const auto addTop = [&](double x, double z) {
      corners.emplace_back(x, heightAt(time) - 0.9 + uniform(random, -noise, noise), z);
    };
    for (const double x : {-0.5, 0.5}) {
      for (const double z : {-0.5, 0.5}) {
        corners.emplace_back(x, -0.1, z);
        addTop(x, z);
      }
    }
    for (int i = 0; i < 24; ++i) {
      const double x = uniform(random, -0.5, 0.5);
      addTop(x, uniform(random, -0.5, 0.5));
    }
    for (std::size_t i = corners.size() - 1; i > 0; --i) std::swap(corners[i], corners[random() % (i + 1)]);
    return corners;
  }
};

/// Motion of boxes on a table after their first second.
struct Rest {
  double creep = 0.0;      ///< maximum sideways motion of a box from the first second to the last [m]
  double offHeight = 0.0;  ///< maximum deviation from the height on the table [m]
  double tilt = 0.0;       ///< maximum [rad]
  double speed = 0.0;      ///< maximum [m/s]
  int framesAlone = 0;     ///< frames in which nothing touched the table
};

Rest restOn(const Table& table, int boxes, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  World world;
  for (int i = 0; i < boxes; ++i) {
    Prop box;
    box.halfExtents = Vec3::Constant(kHalf);
    box.worldFromProp = at(0, kTop + 0.001 + kHalf * (2 * i + 1), 0);
    world.addProp(box);
  }
  LivePart part = makeBoxPart(Vec3(0.5, 0.1, 0.5), at(0, 0.9, 0));
  std::vector<Vec3> first;
  Rest rest;
  for (int frame = 0; frame < 300; ++frame) {
    test::reshape(part, table.cornersAt(frame * kFrame, random));
    world.step({&part, 1}, kFrame);
    if (frame < 30) continue;
    rest.framesAlone += world.contacts().empty() ? 1 : 0;
    for (int i = 0; i < boxes; ++i) {
      const Prop& box = world.props()[i];
      const Vec3 position = box.worldFromProp.translation();
      if (frame == 30) first.push_back(position);
      const Vec3 sideways = (position - first[i]).cwiseProduct(Vec3(1, 0, 1));
      if (frame == 299) rest.creep = std::max(rest.creep, sideways.norm());
      const double carried = table.heightAt(frame * kFrame) + kHalf * (2 * i + 1);
      rest.offHeight = std::max(rest.offHeight, std::abs(position.y() - carried));
      rest.tilt = std::max(rest.tilt, std::acos(std::min(1.0, box.worldFromProp.linear()(1, 1))));
      rest.speed = std::max(rest.speed, box.velocity.norm());
    }
  }
  return rest;
}

TEST(WorldRest, ABoxStaysWhereItIsThoughTheTableIsMadeOfOtherVertices) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Rest rest = restOn({}, 1, seed);
    EXPECT_LT(rest.creep, 0.0002);
    EXPECT_LT(rest.offHeight, 0.0012) << "the margin is a millimetre";
    EXPECT_LT(rest.tilt, 0.002);
    EXPECT_EQ(rest.framesAlone, 0);
  }
}

TEST(WorldRest, ABoxStaysWhereItIsOnATableThatTrembles) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const double noise = 0.0002;
    const Rest rest = restOn({.noise = noise}, 1, seed);
    EXPECT_LT(rest.creep, 0.0005);
    EXPECT_LT(rest.offHeight, 0.0012 + noise);
    EXPECT_LT(rest.tilt, 0.005);
    EXPECT_LT(rest.speed, 0.05);
    EXPECT_EQ(rest.framesAlone, 0);
  }
}

TEST(WorldRest, ABoxRidesOnATableThatBreathes) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Rest rest = restOn({.noise = 0.0001, .breath = 0.005}, 1, seed);
    EXPECT_LT(rest.creep, 0.0005);
    EXPECT_LT(rest.offHeight, 0.0015);
    EXPECT_LT(rest.tilt, 0.005);
    EXPECT_LT(rest.speed, 0.05) << "the top itself moves with up to 8 mm/s";
    EXPECT_EQ(rest.framesAlone, 0);
  }
}

TEST(WorldRest, AStackDoesNotCreepApart) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Rest still = restOn({}, 3, seed);
    EXPECT_LT(still.creep, 0.0015);
    const Rest trembling = restOn({.noise = 0.0002}, 3, seed);
    EXPECT_LT(trembling.creep, 0.0015);
    EXPECT_LT(trembling.offHeight, 0.002);
    const Rest breathing = restOn({.noise = 0.0001, .breath = 0.005}, 3, seed);
    EXPECT_LT(breathing.creep, 0.0025);
    EXPECT_LT(breathing.offHeight, 0.002);
  }
}

TEST(WorldRest, ABoxFollowsATableThatSinksSlowly) {
  World world;
  Prop box;
  box.halfExtents = Vec3::Constant(kHalf);
  box.worldFromProp = at(0, kTop + 0.001 + kHalf, 0);
  world.addProp(box);
  LivePart part = makeBoxPart(Vec3(0.5, 0.1, 0.5), at(0, 0.9, 0));
  for (int frame = 0; frame < 150; ++frame) {
    // The vertices move down, not the part: by a centimetre per second, ten times the tolerance of a contact.
    test::reshapeToBox(part, Vec3(0.5, 0.1 - 0.01 * kFrame * frame, 0.5));
    world.step({&part, 1}, kFrame);
  }
  EXPECT_NEAR(world.props()[0].worldFromProp.translation().y(), 0.9 + 0.1 - 0.01 * kFrame * 149 + kHalf, 0.0015);
}

}  // namespace
}  // namespace lorica
