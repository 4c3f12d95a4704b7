// What a small scene can ask for: many places for particles beside many bodies.

#include "collision/particles/particle_bodies.h"
#include "collision/particles/particle_grid.h"
#include "collision/particles/particles.h"
#include "geometry/random_numbers.h"
#include "geometry/work_budgets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <vector>

namespace lorica::test {
namespace {

ParticleBody bodyOf(ParticleBody::Shape shape, const Vec3& half, const Vec3& at) {
  ParticleBody body;
  body.shape = shape;
  body.halfExtents = half;
  body.radius = half.norm();
  body.from.worldFromBody.translation() = at;
  body.to = body.from;
  return body;
}

TEST(ParticleBudgets, NoneStartInABodyAndAllOthersDo) {
  ParticleSettings settings;
  settings.radius = 0.02;
  settings.fills.push_back({Vec3(0.1, 1.0, -0.2), Vec3(0.7, 0.5, 0.6)});
  settings.fills.push_back({Vec3(0.1, 2.0, -0.2), Vec3(0.7, 0.5, 0.6), 777});  // its last layer is not full
  // A hull's box is around its radius.
  const std::vector<ParticleBody::Hull> wedge = {{Eigen::Vector4f(0.6f, 0.8f, 0.0f, 0.05f),
                                                  Eigen::Vector4f(-1.0f, 0.0f, 0.0f, 0.1f),
                                                  Eigen::Vector4f(0.0f, -1.0f, 0.0f, 0.1f)}};
  RandomNumbers random(4);
  std::vector<ParticleBody> bodies;
  bodies.reserve(40);
  for (int i = 0; i < 40; ++i) {
    const auto shape = static_cast<ParticleBody::Shape>(i % 5);
    const Vec3 at(random.between(-0.4, 0.6), random.between(0.7, 2.4), random.between(-0.6, 0.2));
    bodies.push_back(bodyOf(shape, Vec3(0.02, random.between(0.05, 0.15), 0.03), at));
    bodies.back().hulls = wedge;
    bodies.back().from.worldFromBody.rotate(Eigen::AngleAxisd(random.between(0.0, 3.0), Vec3(0.6, 0.0, 0.8)));
  }
  const auto near = [&](const Vec3f& place) {
    return std::any_of(bodies.begin(), bodies.end(), [&](const ParticleBody& body) {
      return isWithin(body, place, static_cast<float>(settings.radius));
    });
  };
  std::vector<Vec3f> truth;
  const Particles everywhere(settings);
  for (const Vec3f& place : everywhere.positions()) {
    if (!near(place)) truth.push_back(place);
  }
  ASSERT_LT(truth.size(), everywhere.positions().size() - 100);
  const Particles particles(settings, bodies);
  ASSERT_EQ(particles.positions().size(), truth.size());
  EXPECT_TRUE(std::equal(truth.begin(), truth.end(), particles.positions().begin()));
}

TEST(ParticleBudgets, PlacesAreNotComparedWithAllBodies) {
  ParticleSettings settings;
  settings.radius = 0.1;
  settings.fills.assign(20, {Vec3(0.0, 50.0, 0.0), Vec3(20.0, 20.0, 20.0)});
  std::vector<ParticleBody> bodies;
  bodies.reserve(2'000);
  for (int i = 0; i < 2'000; ++i) {
    bodies.push_back(bodyOf(ParticleBody::Shape::kBox, {10.0, 0.005, 10.0}, {0.0, 0.01 * i, 0.0}));
  }
  const std::clock_t before = std::clock();
  const Particles particles(settings, bodies);
  EXPECT_EQ(particles.positions().size(), static_cast<std::size_t>(kMaxParticles));
  // All pairs would take minutes of a processor's time, and this less than one second.
  EXPECT_LT(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC, 20.0);
}

TEST(ParticleBudgets, PairsOfAParticleAndABodyAreLeftOutAboveTheirLimit) {
  constexpr std::size_t kParticles = 1'000;
  std::vector<ParticleRow> positions;
  positions.reserve(kParticles);
  for (std::size_t i = 0; i < kParticles; ++i) positions.push_back({0.001f * static_cast<float>(i), 0.0f, 0.0f, 0.0f});
  ParticleGrid grid(kParticles);
  grid.sort(positions, 0.1f);
  std::vector<ParticleBody> bodies(kMaxParticlePairs / kParticles + 1,
                                   bodyOf(ParticleBody::Shape::kSphere, Vec3::Ones(), Vec3::Zero()));
  ParticleBodies all;
  all.begin(bodies, 0.01, 1);
  all.advance(0);
  all.gather(grid, positions, 0.1f, 0.0f);
  EXPECT_EQ(all.find(positions, 0.1f).size(), kMaxParticlePairs);
  const std::uint32_t last = kMaxParticlePairs / kParticles;
  EXPECT_EQ(all.contactsOf(last - 1), kParticles);
  EXPECT_EQ(all.contactsOf(last), 0u);
}

}  // namespace
}  // namespace lorica::test
