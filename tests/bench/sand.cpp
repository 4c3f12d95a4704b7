// Cost of a frame of simulated sand or water while the mannequin walks through it, compared with plain scalar code for
// the same contacts in the same run: CSV on standard output.

#include "collision/particles/particles.h"
#include "geometry/clock.h"
#include "geometry/random_numbers.h"
#include "tests/bench/measure.h"
#include "tests/bench/walker.h"
#include "viewer/renderer/renderer.h"

#include <fmt/format.h>
#include <xxhash.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace lorica::bench {
namespace {

constexpr double kFrame = 1.0 / 30.0;

struct Options {
  int grains = 200'000;
  int drops = 100'000;
  int plain = 20'000;
  int settle = 60;  // frames before the walk
  int frames = 90;
};

struct Times {
  std::vector<double> wall, cpu;  // [ms]
  template <class Work>
  void add(const Work& work) {
    const double cpuBefore = cpuSeconds();
    const double begin = now();
    work();
    wall.push_back(1e3 * (now() - begin));
    cpu.push_back(1e3 * (cpuSeconds() - cpuBefore));
  }
  void print(const char* what, std::size_t count, std::uint64_t hash) const {
    fmt::print("{},{},{},{:.1f},{:.1f},{:.1f},{:.1f},{:016x}\n", what, count, wall.size(), medianOf(wall),
               medianOf(cpu), *std::max_element(wall.begin(), wall.end()), *std::max_element(cpu.begin(), cpu.end()),
               hash);
  }
};

std::uint64_t hashOf(std::span<const Vec3f> positions) {
  return XXH3_64bits(positions.data(), positions.size_bytes());
}

/// The same contacts without grid order, persistent lists, SIMD, threads or sleeping: one grain after the other.
class PlainSand {
 public:
  PlainSand(std::span<const Vec3f> positions, float radius) : diameter_(2.0f * radius) {
    for (const Vec3f& position : positions)
      grains_.push_back({position, Vec3f::Zero(), Vec3f::Zero(), Vec3f::Zero(), {}});
  }

  void step(int substeps) {
    const auto seconds = static_cast<float>(kFrame / substeps);
    const Vec3f fall(0.0f, -9.81f * seconds * seconds, 0.0f);
    for (int substep = 0; substep < substeps; ++substep) {
      if (substep % 4 == 0) findNeighbours();
      for (Grain& g : grains_) collide(g, fall, seconds);
      for (Grain& g : grains_) {
        g.position = g.nextPosition;
        g.way = g.nextWay;
      }
    }
  }

  [[nodiscard]] std::vector<Vec3f> positions() const {
    std::vector<Vec3f> result;
    result.reserve(grains_.size());
    for (const Grain& g : grains_) result.push_back(g.position);
    return result;
  }

 private:
  struct Grain {
    Vec3f position, way, nextPosition, nextWay;
    std::vector<std::uint32_t> near;
  };

  void findNeighbours() {
    const float reach = 1.15f * diameter_;
    using Key = std::tuple<int, int, int, std::uint32_t>;
    std::vector<Key> keys;
    keys.reserve(grains_.size());
    const auto cell = [&](float v) { return static_cast<int>(std::floor(v / reach)); };
    for (std::uint32_t i = 0; i < grains_.size(); ++i) {
      const Vec3f& p = grains_[i].position;
      keys.emplace_back(cell(p.z()), cell(p.x()), cell(p.y()), i);
    }
    std::sort(keys.begin(), keys.end());
    for (std::uint32_t i = 0; i < grains_.size(); ++i) {
      Grain& g = grains_[i];
      g.near.clear();
      for (int dz = -1; dz <= 1; ++dz) {
        for (int dx = -1; dx <= 1; ++dx) {
          const int z = cell(g.position.z()) + dz, x = cell(g.position.x()) + dx, y = cell(g.position.y());
          auto key = std::lower_bound(keys.begin(), keys.end(), Key(z, x, y - 1, 0));
          for (; key != keys.end() && *key < Key(z, x, y + 2, 0); ++key) {
            const std::uint32_t j = std::get<3>(*key);
            if (j != i && (grains_[j].position - g.position).squaredNorm() < reach * reach) g.near.push_back(j);
          }
        }
      }
    }
  }

  void collide(Grain& g, const Vec3f& fall, float seconds) const {
    const Vec3f way = g.way + fall;
    const Vec3f at = g.position + way;
    Vec3f sum = Vec3f::Zero();
    float touches = 0.0f;
    for (const std::uint32_t j : g.near) {
      const Vec3f otherWay = grains_[j].way + fall;
      const Vec3f between = at - (grains_[j].position + otherWay);
      const float distance = between.norm();
      if (!(distance < diameter_) || distance < 1e-7f) continue;
      const Vec3f normal = between / distance;
      const Vec3f slip = way - otherWay;
      const float along = slip.dot(normal), overlap = diameter_ - distance;
      const float before = std::max(0.0f, overlap + along);
      const float opening = std::min(before, 0.12f * seconds + 0.1f * std::max(0.0f, before - 0.1f * diameter_));
      const Vec3f sliding = slip - along * normal;
      const float held = std::min(1.0f, 0.4f * overlap / std::max(sliding.norm(), 1e-7f));
      sum += (0.5f + 0.5f * normal.y()) * (std::max(0.0f, overlap - before + opening) * normal - held * sliding);
      touches += 1.0f;
    }
    g.nextWay = way + std::min(1.0f, 2.0f / std::max(touches, 1.0f)) * sum;
    const float below = std::max(0.0f, 0.5f * diameter_ - (g.position.y() + g.nextWay.y()));
    g.nextWay.y() += below;
    const float slide = std::hypot(g.nextWay.x(), g.nextWay.z());
    const float held = std::min(1.0f, 0.4f * below / std::max(slide, 1e-7f));
    g.nextWay.x() -= held * g.nextWay.x();
    g.nextWay.z() -= held * g.nextWay.z();
    const float length = g.nextWay.norm();
    if (length < 0.7f * fall.norm()) g.nextWay.setZero();
    if (length > diameter_) g.nextWay *= diameter_ / length;
    g.nextPosition = g.position + g.nextWay;
  }

  std::vector<Grain> grains_;
  float diameter_;
};

ParticleSettings settingsOf(ParticleSettings::Kind kind, int count) {
  ParticleSettings settings;
  settings.kind = kind;
  // A bed, 30 cm deep, along the walker's path.
  const double step = 2.0 * settings.radius * 1.02;
  const double area = count * step * step * step / 0.3;
  const double width = std::sqrt(area / 2.0);
  settings.fills.push_back({Vec3(0.0, 0.16, 0.3 * width), Vec3(width, 5.0, 2.0 * width), count});
  settings.fills[0].middle.y() = 2.5;
  settings.walls = Aabb{Vec3(-0.5 * width, 0, -0.7 * width), Vec3(0.5 * width, 9, 1.3 * width)};
  return settings;
}

/// Draws what the walker has left, as pictures are drawn without a display.
int drawAll(const Particles& particles, int frames, bool surface) {
  const Result<OffscreenContext> context = OffscreenContext::create();
  if (!context) return fail(context.error());
  Result<Renderer> renderer = Renderer::create(context->getProc());
  if (!renderer) return fail(renderer.error());
  Scene scene;
  scene.particles = particles.positions();
  scene.particleVelocities = particles.velocities();
  scene.particleRadius = static_cast<float>(particles.settings().radius);
  scene.water = surface;
  Camera camera;
  camera.eye = Vec3(1.8, 1.6, 2.6);
  camera.target = Vec3(0.0, 0.2, 0.3);
  Times times;
  std::uint64_t hash = 0;
  for (int f = 0; f <= frames; ++f) {
    if (f == 1) times = {};  // shaders are compiled with the first
    times.add([&] {
      renderer->draw(scene, {}, camera, 1280, 720);
      const Image image = renderer->readBack();
      hash = XXH3_64bits(image.rgba.data(), image.rgba.size());
    });
  }
  times.print(surface ? "drawn as a surface" : "drawn as balls", particles.positions().size(), hash);
  return 0;
}

int run(const Options& options) {
  Result<Walker> walker = makeWalker(16, 120);
  if (!walker) return fail(walker.error());
  fmt::print("what,particles,frames,wall ms,cpu ms,most wall ms,most cpu ms,hash\n");
  for (const auto kind : {ParticleSettings::Kind::kSand, ParticleSettings::Kind::kWater}) {
    const bool sand = kind == ParticleSettings::Kind::kSand;
    Particles particles = Particles::create(settingsOf(kind, sand ? options.grains : options.drops)).value();
    walker->body->update(walker->worldFromModel[0]);
    walker->body->update(walker->worldFromModel[0]);
    Times falling, walking;
    for (int f = 0; f < options.settle; ++f) {
      falling.add([&] { particles.step(walker->body->parts(), kFrame); });
    }
    falling.print(sand ? "sand settles" : "water settles", particles.positions().size(), hashOf(particles.positions()));
    for (int f = 1; f <= options.frames; ++f) {
      const std::size_t pose = std::min(static_cast<std::size_t>(f), walker->worldFromModel.size() - 1);
      walker->body->update(walker->worldFromModel[pose]);
      walking.add([&] { particles.step(walker->body->parts(), kFrame); });
    }
    walking.print(sand ? "walk through sand" : "walk through water", particles.positions().size(),
                  hashOf(particles.positions()));
    for (const bool surface : {false, true}) {
      if (surface && sand) continue;
      if (const int code = drawAll(particles, options.frames, surface); code != 0) return code;
    }
  }
  ParticleSettings few = settingsOf(ParticleSettings::Kind::kSand, options.plain);
  few.walls.reset();
  PlainSand plain(Particles::create(few).value().positions(), static_cast<float>(few.radius));
  Times times;
  for (int f = 0; f < 5; ++f) times.add([&] { plain.step(8); });
  times.print("plain scalar sand without a body", static_cast<std::size_t>(options.plain), hashOf(plain.positions()));
  Particles same = Particles::create(few).value();
  Times own;
  for (int f = 0; f < 5; ++f) own.add([&] { same.step({}, kFrame); });
  own.print("the same sand", static_cast<std::size_t>(options.plain), hashOf(same.positions()));
  return 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  lorica::bench::Options options;
  CLI::App app("Cost of a frame of simulated sand or water");
  app.add_option("--grains", options.grains)->check(CLI::Range(1, 300'000));
  app.add_option("--drops", options.drops)->check(CLI::Range(1, 300'000));
  app.add_option("--plain", options.plain)->check(CLI::Range(1, 300'000));
  app.add_option("--settle", options.settle, "Frames before the walk")->check(CLI::Range(1, 1000));
  app.add_option("--frames", options.frames)->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(options);
}
