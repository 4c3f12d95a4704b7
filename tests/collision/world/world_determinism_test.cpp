#include "collision/world/world.h"
#include "tests/collision/parts.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>

namespace lorica {
namespace {

using test::at;
using test::makeBoxPart;
using test::moveTo;

/// All numbers that a run produces, frame by frame.
struct Trace {
  std::vector<double> numbers;
  void add(const Vec3& v) { numbers.insert(numbers.end(), v.data(), v.data() + 3); }
};

/// Many props around moving, deforming parts. `clutter` allocates memory between the steps and frees some of it, so
/// that Bullet's objects have other addresses, in another order, in each run.
Trace run(std::uint64_t clutterSeed) {
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
  const Trace first = run(0);
  ASSERT_GT(first.numbers.size(), 300u * 40u * 9u) << "there are contacts";
  for (std::uint64_t seed : {0u, 1u, 2u, 3u}) {
    const Trace again = run(seed);
    ASSERT_EQ(again.numbers.size(), first.numbers.size()) << "clutter " << seed;
    EXPECT_EQ(std::memcmp(again.numbers.data(), first.numbers.data(), first.numbers.size() * sizeof(double)), 0)
        << "clutter " << seed;
  }
}

}  // namespace
}  // namespace lorica
