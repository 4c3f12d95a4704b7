#include "collision/world/world.h"

#include "tests/collision/parts.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>

namespace lorica {
namespace {

using test::at;
using test::makeBoxPart;
using test::moveTo;
using test::uniform;

constexpr double kFrame = 1.0 / 30.0;

Prop box(const Vec3& halfExtents, const Isometry3& pose, const Vec3& velocity = Vec3::Zero()) {
  Prop prop;
  prop.halfExtents = halfExtents;
  prop.worldFromProp = pose;
  prop.velocity = velocity;
  return prop;
}

Prop ball(double radius, const Isometry3& pose, const Vec3& velocity = Vec3::Zero()) {
  Prop prop = box(Vec3::Constant(radius), pose, velocity);
  prop.shape = PropShape::kSphere;
  return prop;
}

World weightless() {
  World::Settings settings;
  settings.gravity = Vec3::Zero();
  return World(settings);
}

void run(World& world, double seconds) {
  for (int i = 0; i < static_cast<int>(std::lround(seconds / kFrame)); ++i) world.step({}, kFrame);
}

TEST(WorldProps, FreeFallFollowsTheParabola) {
  World world;
  world.addProp(box(Vec3::Constant(0.1), at(0, 20, 0), Vec3(1, 0, 0)));
  run(world, 1.0);
  const Prop& prop = world.props()[0];
  // Symplectic Euler is ahead of the parabola by g t h / 2.
  EXPECT_NEAR(prop.worldFromProp.translation().y(), 20 - 0.5 * 9.81 - 0.5 * 9.81 / 240, 1e-3);
  EXPECT_NEAR(prop.worldFromProp.translation().x(), 1.0, 1e-3);
  EXPECT_NEAR(prop.velocity.y(), -9.81, 1e-3);
}

TEST(WorldProps, BoxesAndBallsRestOnTheFloorAtTheirHalfHeight) {
  for (double half : {0.03, 0.1, 0.25}) {
    World world;
    world.addProp(box(Vec3(half, 0.5 * half, half), at(0, 1, 0)));
    world.addProp(ball(half, at(2, 1, 0)));
    run(world, 4.0);
    EXPECT_NEAR(world.props()[0].worldFromProp.translation().y(), 0.5 * half, 0.002) << half;
    EXPECT_NEAR(world.props()[1].worldFromProp.translation().y(), half, 0.002) << half;
    EXPECT_LT(world.props()[0].velocity.norm(), 0.02);
  }
}

/// Forty boxes of 10 cm thickness, thrown down in all orientations.
World hail(double slowest, double fastest) {
  World world;
  std::mt19937_64 random(21);
  for (int i = 0; i < 40; ++i) {
    Isometry3 pose = at(2.0 * (i % 8) - 8.0, 3.0, 2.0 * (i / 8) - 5.0);
    pose.rotate(test::uniformRotation(random));
    const double speed = slowest + (fastest - slowest) * i / 39.0;
    world.addProp(box(Vec3(0.1, 0.05, 0.15), pose, Vec3(test::uniform(random, -3, 3), -speed, 0)));
  }
  return world;
}

TEST(WorldProps, TheMiddleOfAThrownBoxStaysAboveTheFloor) {
  World world = hail(1.0, 12.0);
  for (int frame = 0; frame < 150; ++frame) {
    world.step({}, kFrame);
    for (const Prop& prop : world.props()) {
      EXPECT_GT(prop.worldFromProp.translation().y(), 0.0) << "frame " << frame;
    }
  }
}

TEST(WorldProps, NothingGoesThroughTheFloorHoweverFast) {
  // At 130 m/s a box moves half a metre in a substep, so it is in the floor for one or two; it must come back.
  World world = hail(20.0, 130.0);
  run(world, 15.0);
  for (const Prop& prop : world.props()) {
    ASSERT_TRUE(prop.worldFromProp.matrix().allFinite());
    EXPECT_GT(prop.worldFromProp.translation().y(), 0.047);
    EXPECT_LT(prop.worldFromProp.translation().y(), 0.16);
  }
}

TEST(WorldProps, CollisionsKeepMomentumAndMakeNoEnergy) {
  std::mt19937_64 random(22);
  for (int i = 0; i < 20; ++i) {
    World world = weightless();
    Prop a = i % 2 == 0 ? ball(0.1, at(-0.5, 5, 0)) : box(Vec3::Constant(0.1), at(-0.5, 5, 0));
    Prop b = i % 3 == 0 ? ball(0.15, at(0.5, 5.03, 0.02)) : box(Vec3(0.1, 0.2, 0.1), at(0.5, 5.03, 0.02));
    a.mass = test::uniform(random, 0.2, 3.0);
    b.mass = test::uniform(random, 0.2, 3.0);
    a.velocity = Vec3(test::uniform(random, 1, 5), 0, 0);
    b.velocity = Vec3(-test::uniform(random, 1, 5), 0, 0);
    a.restitution = b.restitution = test::uniform(random, 0, 1);
    const Vec3 momentum = a.mass * a.velocity + b.mass * b.velocity;
    const double energy = 0.5 * (a.mass * a.velocity.squaredNorm() + b.mass * b.velocity.squaredNorm());
    world.addProp(a);
    world.addProp(b);
    run(world, 1.0);
    const Vec3 va = world.props()[0].velocity;
    const Vec3 vb = world.props()[1].velocity;
    EXPECT_LT(va.x(), vb.x()) << "they met and separated, case " << i;
    EXPECT_LT((a.mass * va + b.mass * vb - momentum).norm(), 1e-4) << "case " << i;
    EXPECT_LE(0.5 * (a.mass * va.squaredNorm() + b.mass * vb.squaredNorm()), energy * 1.001) << "case " << i;
  }
}

TEST(WorldProps, AStackStands) {
  World world;
  for (int i = 0; i < 10; ++i) world.addProp(box(Vec3::Constant(0.1), at(0.01 * (i % 2), 0.1 + 0.2 * i, 0)));
  run(world, 20.0);
  for (int i = 0; i < 10; ++i) {
    const Vec3 pose = world.props()[i].worldFromProp.translation();
    EXPECT_LT((pose - Vec3(0.01 * (i % 2), 0.1 + 0.2 * i, 0)).norm(), 0.006) << "box " << i;
  }
}

TEST(WorldProps, NoTimeMovesNothing) {
  World world;
  world.addProp(box(Vec3::Constant(0.1), at(0, 2, 0), Vec3(1, 2, 3)));
  world.step({}, 0.0);
  EXPECT_LT((world.props()[0].worldFromProp.translation() - Vec3(0, 2, 0)).norm(), 1e-6);
  EXPECT_LT((world.props()[0].velocity - Vec3(1, 2, 3)).norm(), 1e-6);
}

TEST(WorldProps, AWorldCanBeMoved) {
  World first;
  first.addProp(box(Vec3::Constant(0.1), at(0, 1, 0)));
  World second = std::move(first);
  run(second, 1.0);
  EXPECT_EQ(second.props().size(), 1u);
  EXPECT_LT(second.props()[0].worldFromProp.translation().y(), 0.2);
}

Prop shaped(PropShape shape, double radius, double halfHeight, const Isometry3& pose) {
  Prop prop = box(Vec3(radius, halfHeight, radius), pose);
  prop.shape = shape;
  return prop;
}

TEST(WorldProps, CapsulesAndCylindersRestOnTheirSidesAndEnds) {
  World world;
  Isometry3 lying = at(0, 0.5, 0);
  lying.rotate(Eigen::AngleAxisd(0.5 * EIGEN_PI, Vec3::UnitZ()));
  world.addProp(shaped(PropShape::kCapsule, 0.08, 0.3, lying));
  lying.translation().x() = 2.0;
  world.addProp(shaped(PropShape::kCylinder, 0.08, 0.3, lying));
  world.addProp(shaped(PropShape::kCylinder, 0.2, 0.1, at(4, 0.5, 0)));
  run(world, 4.0);
  EXPECT_NEAR(world.props()[0].worldFromProp.translation().y(), 0.08, 0.002);
  EXPECT_NEAR(world.props()[1].worldFromProp.translation().y(), 0.08, 0.002);
  EXPECT_NEAR(world.props()[2].worldFromProp.translation().y(), 0.1, 0.002);
}

TEST(WorldProps, StaticBodiesStayAndCarryProps) {
  World world;
  Prop table = box(Vec3(0.5, 0.02, 0.5), at(0, 0.7, 0));
  table.mass = 0.0;
  world.addProp(table);
  world.addProp(box(Vec3::Constant(0.1), at(0, 1.0, 0)));
  run(world, 4.0);
  EXPECT_NEAR(world.props()[0].worldFromProp.translation().y(), 0.7, 1e-6);
  EXPECT_NEAR(world.props()[1].worldFromProp.translation().y(), 0.82, 0.002);
}

TEST(WorldProps, ARodSwingsAsFastAsItsLengthSays) {
  World world;
  // A thin rod of 1 m length, suspended at one end and deflected by 0.1 rad.
  const Vec3 pivot(0, 3, 0);
  Isometry3 pose = Isometry3(Eigen::Translation3d(pivot)) * Eigen::AngleAxisd(0.1, Vec3::UnitZ());
  pose.translate(Vec3(0, -0.5, 0));
  world.addProp(shaped(PropShape::kCapsule, 0.01, 0.5, pose));
  world.addLink(0, kWorldItself, pivot);
  double previous = pose.translation().x();
  ASSERT_GT(previous, 0.0);
  std::vector<double> crossings;  // downwards through the middle
  for (int i = 0; i < 400; ++i) {
    world.step({}, 1.0 / 120.0);
    const Isometry3& now = world.props()[0].worldFromProp;
    EXPECT_NEAR((now * Vec3(0, 0.5, 0) - pivot).norm(), 0.0, 0.005);
    const double x = now.translation().x();
    if (previous > 0.0 && x <= 0.0) crossings.push_back((i + previous / (previous - x)) / 120.0);
    previous = x;
  }
  ASSERT_GE(crossings.size(), 2u);
  const double truth = 2.0 * EIGEN_PI * std::sqrt(2.0 * 1.0 / (3.0 * 9.81));
  EXPECT_NEAR(crossings[1] - crossings[0], truth, 0.02 * truth);
}

TEST(WorldProps, WithoutAFloorThingsFallOn) {
  World::Settings settings;
  settings.floor = false;
  World world(settings);
  world.addProp(ball(0.1, at(0, 0.5, 0)));
  run(world, 1.0);
  EXPECT_LT(world.props()[0].worldFromProp.translation().y(), -3.0);
}

long peakMegabytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

/// 700 boxes in one place are 244,650 pairs, which took 900 MB.
TEST(WorldPairs, BoxesInOnePlaceTakeBoundedMemory) {
  const long before = peakMegabytes();
  World world;
  Prop box;
  box.worldFromProp.translation() = Vec3(0.0, 1.0, 0.0);
  for (int i = 0; i < 700; ++i) world.addProp(box);
  world.step({}, 1.0 / 240.0);
  EXPECT_LT(peakMegabytes() - before, 400);
  for (const Prop& prop : world.props()) EXPECT_TRUE(prop.worldFromProp.matrix().allFinite());
}

/// All numbers that a run produces, frame by frame.
struct Trace {
  std::vector<double> numbers;
  void add(const Vec3& v) { numbers.insert(numbers.end(), v.data(), v.data() + 3); }
};

/// Many props around moving, deforming parts. `clutter` allocates memory between the steps and frees some of it, so
/// that Bullet's objects have other addresses, in another order, in each run.
Trace runCluttered(std::uint64_t clutterSeed) {
  std::mt19937_64 clutter(clutterSeed);
  std::vector<std::unique_ptr<char[]>> memory;
  const auto stir = [&] {
    if (clutterSeed == 0) return;
    // Many small blocks, most of them freed in random order, so that the next blocks of these sizes come from anywhere.
    for (int i = 0; i < 2000; ++i) memory.push_back(std::make_unique<char[]>(16 + clutter() % 256));
    for (int i = 0; i < 1900; ++i) std::swap(memory[clutter() % memory.size()], memory.back()), memory.pop_back();
  };

  std::mt19937_64 random(41);
  World world;
  for (int i = 0; i < 40; ++i) {
    stir();
    Prop prop;
    prop.shape = i % 3 == 0 ? PropShape::kSphere : PropShape::kBox;
    prop.halfExtents = test::uniformVec3(random, 0.05, 0.15);
    const double x = test::uniform(random, -0.5, 0.5);
    const double z = test::uniform(random, -0.5, 0.5);
    prop.worldFromProp = at(x, 0.3 + 0.3 * i, z);
    prop.worldFromProp.rotate(test::uniformRotation(random));
    world.addProp(prop);
  }
  std::vector<LivePart> parts;
  for (int i = 0; i < 8; ++i) parts.push_back(makeBoxPart(Vec3::Constant(0.12), at(0, 0.2 * i, 0)));

  Trace trace;
  for (int frame = 0; frame < 300; ++frame) {
    stir();
    for (LivePart& part : parts) {
      Isometry3 next = part.worldFromPart;
      next.translation() += test::uniformVec3(random, -0.1, 0.1);
      next.translation() = next.translation().cwiseMax(Vec3(-0.5, 0.0, -0.5)).cwiseMin(Vec3(0.5, 1.8, 0.5));
      next.rotate(Quat::Identity().slerp(0.05, test::uniformRotation(random)));
      moveTo(part, next);
      if (random() % 3 == 0) test::reshapeToBox(part, test::uniformVec3(random, 0.05, 0.2));
    }
    world.step(parts, 1.0 / 30.0);
    for (const Prop& prop : world.props()) {
      trace.add(prop.worldFromProp.translation());
      trace.add(prop.worldFromProp.linear().col(0));
      trace.add(prop.velocity);
    }
    for (const Contact& contact : world.contacts()) {
      trace.add(contact.point);
      trace.add(Vec3(contact.part, contact.prop, contact.impulse));
    }
  }
  return trace;
}

TEST(WorldDeterminism, TheSameInputsMoveEveryPropTheSameBitForBitWhereverMemoryLies) {
  const Trace first = runCluttered(0);
  ASSERT_GT(first.numbers.size(), 300u * 40u * 9u) << "there are contacts";
  for (std::uint64_t seed : {0u, 1u, 2u, 3u}) {
    const Trace again = runCluttered(seed);
    ASSERT_EQ(again.numbers.size(), first.numbers.size()) << "clutter " << seed;
    EXPECT_EQ(std::memcmp(again.numbers.data(), first.numbers.data(), first.numbers.size() * sizeof(double)), 0)
        << "clutter " << seed;
  }
}

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
