#include "collision/particles/particle_push.h"

#include "collision/live/live_body.h"
#include "collision/live/live_part.h"
#include "collision/particles/particle_bodies.h"
#include "collision/particles/particle_grid.h"
#include "collision/particles/particles.h"
#include "geometry/math.h"
#include "geometry/random_numbers.h"
#include "geometry/work_budgets.h"
#include "tests/collision/parts.h"
#include "tests/support/allocations.h"
#include "tests/support/instruction_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <limits>
#include <span>
#include <vector>

namespace lorica::test {
namespace {

/// Slow reference for the hulls of live parts: all planes of all hulls, in double precision.
class ParticleTruth {
 public:
  explicit ParticleTruth(std::span<const LivePart> parts);

  /// How far a point is above the highest plane of a part's hull [m]: below 0 inside. A part without faces is
  /// infinitely distant.
  [[nodiscard]] double height(std::size_t part, const Vec3& p) const;
  /// The min height over all parts.
  [[nodiscard]] double lowest(const Vec3& p) const;
  /// Whether a face of a part's hull has this normal and a plane within this distance of the point [m].
  [[nodiscard]] bool hasFace(std::size_t part, const Vec3& p, const Vec3& normal, double distance) const;
  /// Approximate upper bound of the shortest distance out of all hulls, tried along many directions; 0 outside.
  [[nodiscard]] double wayOut(const Vec3& p) const;

 private:
  struct Plane {
    Vec3 normal;
    double offset = 0.0;
  };
  std::vector<std::vector<Plane>> planes_;  ///< for each part
  std::vector<Vec3> directions_;
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

ParticleTruth::ParticleTruth(std::span<const LivePart> parts) {
  for (const LivePart& part : parts) {
    std::vector<Plane>& planes = planes_.emplace_back();
    const ConvexHull hull = worldHull(part);
    for (const Triangle& t : hull.triangles) {
      const Vec3& a = hull.vertices[t[0]];
      const Vec3& b = hull.vertices[t[1]];
      const Vec3& c = hull.vertices[t[2]];
      const Vec3 cross = (b - a).cross(c - a);
      if (!(cross.norm() > 1e-12)) continue;
      planes.push_back({cross.normalized(), cross.normalized().dot(a)});
    }
  }
  std::mt19937_64 random(1);
  for (int i = 0; i < 300; ++i) directions_.emplace_back(uniformRotation(random) * Vec3::UnitX());
}

double ParticleTruth::height(std::size_t part, const Vec3& p) const {
  double max = -kInfinity;
  for (const Plane& plane : planes_[part]) max = std::max(max, plane.normal.dot(p) - plane.offset);
  return planes_[part].empty() ? kInfinity : max;
}

double ParticleTruth::lowest(const Vec3& p) const {
  double min = kInfinity;
  for (std::size_t part = 0; part < planes_.size(); ++part) min = std::min(min, height(part, p));
  return min;
}

bool ParticleTruth::hasFace(std::size_t part, const Vec3& p, const Vec3& normal, double distance) const {
  return std::any_of(planes_[part].begin(), planes_[part].end(), [&](const Plane& plane) {
    return std::abs(plane.normal.dot(p) - plane.offset) < distance && plane.normal.dot(normal) > 1.0 - 1e-6;
  });
}

double ParticleTruth::wayOut(const Vec3& p) const {
  double shortest = lowest(p) < 0.0 ? kInfinity : 0.0;
  for (const Vec3& direction : directions_) {
    // The interval of the ray inside each hull. The way out extends as long as an interval covers its end.
    std::vector<std::pair<double, double>> covered;
    for (const std::vector<Plane>& planes : planes_) {
      double from = 0.0;
      double to = planes.empty() ? -1.0 : kInfinity;
      for (const Plane& plane : planes) {
        const double rise = plane.normal.dot(direction);
        const double depth = plane.offset - plane.normal.dot(p);
        if (rise > 0.0) to = std::min(to, depth / rise);
        if (rise < 0.0) from = std::max(from, depth / rise);
      }
      if (from < to) covered.emplace_back(from, to);
    }
    std::sort(covered.begin(), covered.end());
    double way = 0.0;
    for (const auto& [from, to] : covered) {
      if (from <= way) way = std::max(way, to);
    }
    shortest = std::min(shortest, way);
  }
  return shortest;
}

constexpr double kSecond = 1.0;
constexpr double kRounding = 3e-5;  // of floats up to 10 m from the origin, and the margin [m]

std::vector<Vec3f> particlesIn(const Aabb& box, std::size_t count, std::mt19937_64& random) {
  std::vector<Vec3f> particles(count);
  for (Vec3f& p : particles) {
    const Vec3 share = uniformVec3(random, 0.0, 1.0);
    p = (box.min + share.cwiseProduct(box.max - box.min)).cast<float>();
  }
  return particles;
}

Aabb boundsOfParts(std::span<const LivePart> parts, double more) {
  Aabb box;
  for (const LivePart& part : parts) {
    for (const Vec3& v : part.shape.vertices) box.extend(part.worldFromPart * v);
  }
  box.min.array() -= more;
  box.max.array() += more;
  return box;
}

/// Random hulls of a few points each around one position, all overlapping.
std::vector<LivePart> randomParts(std::mt19937_64& random, int count) {
  std::vector<LivePart> parts(static_cast<std::size_t>(count));
  for (LivePart& part : parts) {
    std::vector<Vec3> corners(6 + random() % 60);
    const Vec3 size = uniformVec3(random, 0.02, 0.4);
    for (Vec3& corner : corners) corner = size.cwiseProduct(uniformVec3(random, -1.0, 1.0));
    Isometry3 pose = at(0, 0, 0);
    pose.linear() = uniformRotation(random).toRotationMatrix();
    pose.translation() = uniformVec3(random, -0.5, 0.5);
    part.worldFromPart = pose;
    part.previousWorldFromPart = pose;
    reshape(part, corners);
  }
  return parts;
}

/// Pushes, and compares every particle with the reference: which were touched, what was reported, and the new
/// positions.
/// @return how many were touched
std::size_t expectPushed(std::span<const LivePart> parts, std::vector<Vec3f> particles, const std::string& what) {
  SCOPED_TRACE(what);
  const ParticleTruth truth(parts);
  ParticlePush push = ParticlePush::create().value();
  push.prepare(parts, kSecond);
  const std::vector<Vec3f> before = particles;
  const std::span<const ParticleTouch> touches = push.push(particles);
  std::size_t next = 0;
  double sum = 0.0;
  double minSum = 0.0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Vec3 was = before[i].cast<double>();
    const Vec3 is = particles[i].cast<double>();
    const double height = truth.lowest(was);
    const bool touched = next < touches.size() && touches[next].particle == i;
    EXPECT_TRUE(touched ? height < kRounding : height > -kRounding) << i << ": " << height;
    EXPECT_GT(truth.lowest(is), -kRounding) << i << " is inside; its height was " << height;
    if (!touched) {
      EXPECT_EQ(before[i], particles[i]);
      continue;
    }
    const ParticleTouch& touch = touches[next++];
    EXPECT_NEAR(touch.depth, (is - was).norm(), kRounding);
    EXPECT_NEAR(touch.normal.norm(), 1.0, 1e-5);
    EXPECT_NEAR(truth.height(touch.part, is), 0.0, 4 * kRounding) << "on the surface of the reported part";
    EXPECT_TRUE(truth.hasFace(touch.part, is, touch.normal.cast<double>(), 2 * kRounding))
        << "the normal is that of a face";
    const LivePart& part = parts[touch.part];
    EXPECT_NEAR((touch.surfaceVelocity.cast<double>() - velocityAt(part, is, kSecond)).norm(), 0.0, 1e-4);
    if (next % 4 != 0) continue;
    const double way = truth.wayOut(was);
    EXPECT_LE(touch.depth, 4.0 * way + 5e-3) << i << ": there is a much nearer way out";
    sum += touch.depth;
    minSum += way;
  }
  EXPECT_EQ(next, touches.size()) << "touches are in order";
  EXPECT_LE(sum, 1.75 * minSum + 1e-3) << "on average, the distances are close to the shortest";
  EXPECT_TRUE(push.push(particles).empty()) << "particles that are outside stay in place";
  return touches.size();
}

TEST(ParticlePush, ABoxPushesThroughTheNearestFace) {
  LivePart box = makeBoxPart({0.5, 1.0, 2.0}, at(1, 2, 3));
  std::vector<Vec3f> particles = {{1.4F, 2.0F, 3.0F}, {1.0F, 1.1F, 3.0F}, {1.0F, 2.0F, 4.9F}, {1.6F, 2.0F, 3.0F}};
  ParticlePush push = ParticlePush::create().value();
  push.prepare(std::span(&box, 1), kSecond);
  const std::span<const ParticleTouch> touches = push.push(particles);
  ASSERT_EQ(touches.size(), 3U);
  EXPECT_LT((particles[0] - Vec3f(1.5F, 2.0F, 3.0F)).norm(), kRounding);
  EXPECT_LT((particles[1] - Vec3f(1.0F, 1.0F, 3.0F)).norm(), kRounding);
  EXPECT_LT((particles[2] - Vec3f(1.0F, 2.0F, 5.0F)).norm(), kRounding);
  EXPECT_EQ(particles[3], Vec3f(1.6F, 2.0F, 3.0F));
  EXPECT_LT((touches[1].normal - Vec3f(0, -1, 0)).norm(), 1e-6);
}

TEST(ParticlePush, RandomHullsPushAsAllTheirPlanesSay) {
  std::mt19937_64 random(71);
  std::size_t touched = 0;
  for (int i = 0; i < 40; ++i) {
    const std::vector<LivePart> parts = randomParts(random, 1 + i % 16);
    touched += expectPushed(parts, particlesIn(boundsOfParts(parts, 0.05), 300, random), "case " + std::to_string(i));
  }
  EXPECT_GT(touched, 900U);
}

TEST(ParticlePush, ABodyInAnyPosePushesAsAllItsPlanesSay) {
  Dancer dancer;
  std::mt19937_64 random(72);
  LiveBody body = LiveBody::create(dancer.decomposition, dancer.character).value();
  std::size_t touched = 0;
  for (int i = 0; i < 4; ++i) {
    dancer.dance(random, i == 3 ? 2.5 : 0.4);  // in the last pose the body intersects itself
    body.update(dancer.worldFromModel);
    if (i == 0) continue;
    touched += expectPushed(body.parts(), particlesIn(boundsOfParts(body.parts(), 0.02), 700, random),
                            "pose " + std::to_string(i));
  }
  EXPECT_GT(touched, 50U);
}

TEST(ParticlePush, ThinPlatesPushAndFlatOnesDoNot) {
  std::mt19937_64 random(73);
  std::vector<LivePart> parts = {makeBoxPart({0.5, 1e-4, 0.5}, at(0, 1, 0)), makeBoxPart({0.5, 1.0, 0.5}, at(3, 1, 0)),
                                 makeBoxPart({0.5, 1.0, 0.5}, at(6, 1, 0)), LivePart()};
  parts[2].worldFromPart.translation().x() = std::numeric_limits<double>::quiet_NaN();
  parts.push_back(makeBoxPart({1, 1, 1}, at(1e300, 0, 0)));
  std::vector<Vec3f> particles(2000);
  for (Vec3f& p : particles) {
    p = uniformVec3(random, -0.5, 0.5).cast<float>();
    p.y() = 1.0F + 4e-4F * p.y();
  }
  const auto only = std::span(parts).first(1);
  EXPECT_GT(expectPushed(only, particles, "a plate of 0.2 mm"), 500U);
  reshape(parts[1], std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}});
  ASSERT_TRUE(parts[1].shape.degenerate());
  ParticlePush push = ParticlePush::create().value();
  push.prepare(std::span(parts).last(4), kSecond);
  std::vector<Vec3f> at3(1, Vec3f(3.2F, 1.0F, 0.2F));
  EXPECT_TRUE(push.push(at3).empty());
  push.prepare({}, kSecond);
  EXPECT_TRUE(push.push(at3).empty());
  push.prepare(parts, kSecond);
  EXPECT_TRUE(push.push({}).empty());
  const std::size_t expected = expectPushed(only, particles, "alone");
  EXPECT_EQ(push.push(particles).size(), expected) << "beside parts that push nothing";
}

TEST(ParticlePush, PositionsThatAreNoNumbersAreLeftAlone) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const LivePart box = makeBoxPart({1, 1, 1}, at(0, 0, 0));
  ParticlePush push = ParticlePush::create().value();
  push.prepare(std::span(&box, 1), kSecond);
  // A whole vector of each, and some more.
  for (const Vec3f& odd : {Vec3f(nan, 0, 0), Vec3f(0, nan, 0), Vec3f(0, 0, nan), Vec3f(infinity, 0, 0),
                           Vec3f(0, -infinity, 0), Vec3f(1e30F, 0, 0), Vec3f(nan, nan, nan)}) {
    std::vector<Vec3f> particles(37, odd);
    particles[20] = {0.9F, 0, 0};
    const std::vector<Vec3f> before = particles;
    const std::span<const ParticleTouch> touches = push.push(particles);
    ASSERT_EQ(touches.size(), 1U);
    EXPECT_EQ(touches[0].particle, 20U);
    particles[20] = before[20];
    EXPECT_EQ(std::memcmp(particles.data(), before.data(), before.size() * sizeof(Vec3f)), 0);
  }
}

TEST(ParticlePush, GrainsAreKeptByTheirRadius) {
  std::mt19937_64 random(74);
  constexpr double kRadius = 0.02;
  const LivePart box = makeBoxPart({0.1, 0.2, 0.3}, at(0, 1, 0));
  ParticlePush push = ParticlePush::create({.radius = kRadius}).value();
  push.prepare(std::span(&box, 1), kSecond);
  std::vector<Vec3f> particles = particlesIn(boundsOfParts(std::span(&box, 1), 0.05), 2000, random);
  const std::vector<Vec3f> before = particles;
  const ParticleTruth truth(std::span(&box, 1));
  const std::size_t count = push.push(particles).size();
  std::size_t expected = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const bool near = truth.lowest(before[i].cast<double>()) < kRadius;
    expected += near ? 1 : 0;
    EXPECT_EQ(near, before[i] != particles[i]);
    EXPECT_GT(truth.lowest(particles[i].cast<double>()), kRadius - kRounding);
  }
  EXPECT_EQ(count, expected);
}

TEST(ParticlePush, TellsHowFastTheSurfaceMoves) {
  LivePart box = makeBoxPart({0.5, 0.5, 0.5}, at(1, 1, 1));
  Isometry3 turned = at(1.1, 1.0, 0.8);
  turned.linear() = Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  moveTo(box, turned);
  std::mt19937_64 random(75);
  std::vector<Vec3f> particles = particlesIn(boundsOfParts(std::span(&box, 1), 0.0), 500, random);
  const std::vector<Vec3f> before = particles;
  for (const double trust : {1.0, 0.25, 0.0}) {
    box.trust = trust;
    particles = before;
    ParticlePush push = ParticlePush::create().value();
    push.prepare(std::span(&box, 1), 0.02);
    const std::span<const ParticleTouch> touches = push.push(particles);
    EXPECT_GT(touches.size(), 100U);
    for (const ParticleTouch& touch : touches) {
      const Vec3 expected = trust * velocityAt(box, particles[touch.particle].cast<double>(), 0.02);
      EXPECT_NEAR((touch.surfaceVelocity.cast<double>() - expected).norm(), 0.0, 1e-3);
    }
  }
}

TEST(ParticlePush, VelocityChangesAsCoulombSays) {
  ParticleTouch touch{};
  touch.normal = Vec3f::UnitY();
  touch.surfaceVelocity = Vec3f(1, 2, 0);
  const auto after = [&](const Vec3f& v, float friction) -> Vec3f { return v + velocityChange(touch, v, friction); };
  EXPECT_EQ(after({0, 3, 0}, 1.0F), Vec3f(0, 3, 0)) << "the particle is already leaving";
  EXPECT_EQ(after({0, 0, 0}, 0.0F), Vec3f(0, 2, 0)) << "without friction, along the normal only";
  EXPECT_LT((after({0, 0, 0}, 0.25F) - Vec3f(0.5F, 2, 0)).norm(), 1e-6) << "a quarter of the push";
  EXPECT_LT((after({0, 0, 0}, 5.0F) - Vec3f(1, 2, 0)).norm(), 1e-6)
      << "it sticks and is not accelerated past the surface";
  EXPECT_EQ(after({1, 1, 0}, 0.5F), Vec3f(1, 2, 0)) << "nothing slides";
}

/// The result of a push, bit by bit.
std::vector<unsigned char> bytesOf(const std::vector<Vec3f>& particles, std::span<const ParticleTouch> touches) {
  std::vector<unsigned char> bytes(particles.size() * sizeof(Vec3f) + touches.size_bytes());
  std::memcpy(bytes.data(), particles.data(), particles.size() * sizeof(Vec3f));
  if (!touches.empty()) {
    std::memcpy(bytes.data() + particles.size() * sizeof(Vec3f), touches.data(), touches.size_bytes());
  }
  return bytes;
}

TEST(ParticlePush, OneThreadEqualsManyAndEveryInstructionSetTheOthers) {
  std::mt19937_64 random(76);
  const std::vector<LivePart> parts = randomParts(random, 16);
  const std::vector<Vec3f> all = particlesIn(boundsOfParts(parts, 0.05), 30'000, random);
  std::vector<unsigned char> expected;
  std::size_t touched = 0;
  onEveryInstructionSet([&] {
    for (const int threads : {1, 2}) {
      ParticlePush push = ParticlePush::create({.threads = threads}).value();
      push.prepare(parts, kSecond);
      std::vector<Vec3f> particles = all;
      const std::span<const ParticleTouch> touches = push.push(particles);
      const std::vector<unsigned char> bytes = bytesOf(particles, touches);
      if (expected.empty()) expected = bytes;
      EXPECT_TRUE(bytes == expected) << threads << " threads";
      touched = touches.size();
    }
  });
  EXPECT_GT(touched, 1000U);
}

TEST(ParticlePush, AnyNumberOfParticlesIsPushedAsOneByOne) {
  std::mt19937_64 random(77);
  const std::vector<LivePart> parts = randomParts(random, 5);
  const std::vector<Vec3f> all = particlesIn(boundsOfParts(parts, 0.0), 8200, random);
  ParticlePush push = ParticlePush::create().value();
  push.prepare(parts, kSecond);
  std::vector<Vec3f> alone = all;
  for (Vec3f& p : alone) (void)push.push(std::span(&p, 1));
  onEveryInstructionSet([&] {
    for (const std::size_t count :
         std::initializer_list<std::size_t>{3U, 4U, 5U, 7U, 8U, 9U, 15U, 16U, 17U, 4095U, 4096U, 4097U, 8200U}) {
      std::vector<Vec3f> particles(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
      (void)push.push(particles);
      EXPECT_EQ(std::memcmp(particles.data(), alone.data(), count * sizeof(Vec3f)), 0) << count;
    }
  });
}

TEST(ParticlePush, FramesAllocateNothing) {
  Dancer dancer;
  std::mt19937_64 random(78);
  LiveBody body = LiveBody::create(dancer.decomposition, dancer.character).value();
  std::vector<std::vector<LivePart>> frames;
  for (int i = 0; i < 6; ++i) {
    dancer.dance(random, 0.4);
    body.update(dancer.worldFromModel);
    frames.emplace_back(body.parts().begin(), body.parts().end());
  }
  std::vector<Vec3f> particles = particlesIn(boundsOfParts(body.parts(), 0.1), 20'000, random);
  ParticlePush push = ParticlePush::create({.threads = 1}).value();
  std::size_t touched = 0;
  const auto all = [&] {
    for (const std::vector<LivePart>& frame : frames) {
      push.prepare(frame, kSecond);
      touched += push.push(particles).size();
    }
  };
  all();
  const long before = allocationCount();
  ASSERT_GT(before, 0) << "the counter works: the setup allocated memory";
  all();
  EXPECT_EQ(allocationCount() - before, 0);
  EXPECT_GT(touched, 100U);
}

// What a small scene can ask for: many places for particles beside many bodies.

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
  const Particles everywhere = Particles::create(settings).value();
  for (const Vec3f& place : everywhere.positions()) {
    if (!near(place)) truth.push_back(place);
  }
  ASSERT_LT(truth.size(), everywhere.positions().size() - 100);
  const Particles particles = Particles::create(settings, bodies).value();
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
  const Particles particles = Particles::create(settings, bodies).value();
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
