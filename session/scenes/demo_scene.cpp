#include "session/scenes/demo_scene.h"

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace lorica {
namespace {

const std::array<Vec3f, 6> kPalette = {{{0.83f, 0.29f, 0.13f},
                                        {0.90f, 0.60f, 0.12f},
                                        {0.16f, 0.42f, 0.66f},
                                        {0.20f, 0.55f, 0.33f},
                                        {0.75f, 0.72f, 0.62f},
                                        {0.48f, 0.25f, 0.52f}}};

/// Uniform numbers in [low, high). Unlike the standard's distributions, the same with every library.
double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * (random() >> 11) * 0x1.0p-53;
}

/// Boxes stacked on the floor, each slightly rotated.
void addTower(std::vector<Prop>& props, double x, double z, int count, const Vec3& halfExtents,
              std::mt19937_64& random) {
  for (int i = 0; i < count; ++i) {
    Prop box;
    box.halfExtents = halfExtents;
    box.mass = 0.6;
    box.color = kPalette[i % kPalette.size()];
    box.worldFromProp = Eigen::Translation3d(x, halfExtents.y() * (2 * i + 1), z) *
                        Eigen::AngleAxisd(uniform(random, -0.08, 0.08), Vec3::UnitY());
    props.push_back(box);
  }
}

/// The i-th falling prop: each starts higher than the previous one, so that they arrive one by one.
Prop fallingProp(int i, std::mt19937_64& random) {
  Prop prop;
  prop.shape = i % 2 == 0 ? PropShape::kSphere : PropShape::kBox;
  const double size = uniform(random, 0.06, 0.12);
  // One statement per random number: the evaluation order of arguments differs between compilers.
  prop.halfExtents.setConstant(size);
  if (prop.shape == PropShape::kBox) {
    prop.halfExtents.z() *= uniform(random, 0.6, 1.0);
    prop.halfExtents.y() *= uniform(random, 0.6, 1.0);
  }
  prop.mass = 500.0 * size * size * size * 8.0 * 0.5;  // about the density of cork: light enough to be pushed easily
  prop.restitution = prop.shape == PropShape::kSphere ? 0.55 : 0.2;
  prop.color = kPalette[random() % kPalette.size()];

  // Two of three are aimed at head and shoulders, the others land within reach of arms and feet.
  const double radius = i % 3 != 0 ? uniform(random, 0.0, 0.25) : uniform(random, 0.3, 0.8);
  const double angle = uniform(random, 0.0, 2.0 * std::numbers::pi);
  const double y = uniform(random, -1.0, 1.0);
  const double x = uniform(random, -1.0, 1.0);
  const Vec3 axis = Vec3(x, y, 1.5).normalized();
  prop.worldFromProp = Eigen::Translation3d(radius * std::cos(angle), 2.2 + 0.4 * i, radius * std::sin(angle)) *
                       Eigen::AngleAxisd(uniform(random, 0.0, std::numbers::pi), axis);
  return prop;
}

}  // namespace

World makeDemoWorld(std::uint64_t seed) {
  return makeDemoWorldUnder(World::Settings().gravity, seed);
}

World makeDemoWorldUnder(const Vec3& gravity, std::uint64_t seed, double scale) {
  std::mt19937_64 random(seed);
  World::Settings settings;
  settings.gravity = gravity;
  settings.resolvesOverlaps = true;
  World world(settings);
  std::vector<Prop> props;
  addTower(props, 0.0, 0.60, 6, Vec3(0.14, 0.10, 0.10), random);   // in front: for kicks, punches and reaching
  addTower(props, 0.60, 0.20, 4, Vec3(0.11, 0.11, 0.11), random);  // at the left: for hands moving down
  for (int i = 0; i < 12; ++i) props.push_back(fallingProp(i, random));
  for (Prop& prop : props) {
    prop.worldFromProp.translation() *= scale;
    prop.halfExtents *= scale;
    prop.mass *= scale * scale * scale;
    world.addProp(prop);
  }
  return world;
}

}  // namespace lorica
