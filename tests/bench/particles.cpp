// Cost of pushing millions of particles out of a live body, compared with a plain loop in the same run: CSV on standard
// output.

#include "collision/live/live_body.h"
#include "collision/particles/particle_push.h"
#include "geometry/clock.h"
#include "geometry/random_numbers.h"
#include "tests/bench/measure.h"
#include "tests/bench/walker.h"

#include <fmt/format.h>
#include <xxhash.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica::bench {
namespace {

constexpr double kSecondsOfFrame = 1.0 / 30.0;

struct Options {
  std::size_t particles = 5'000'000;
  int parts = 16;
  int hullVertices = 120;
  int repeats = 7;
};

/// Time of one call: wall clock, and CPU time of all threads [ms].
struct Cost {
  double wall = std::numeric_limits<double>::infinity();
  double cpu = std::numeric_limits<double>::infinity();
};

/// Minimum of several runs, to exclude other load of the machine.
template <class Before, class Work>
Cost minOf(int repeats, const Before& before, const Work& work) {
  Cost min;
  for (int i = 0; i < repeats; ++i) {
    before();
    const double cpu = cpuSeconds();
    const double begin = now();
    work();
    min.wall = std::min(min.wall, 1e3 * (now() - begin));
    min.cpu = std::min(min.cpu, 1e3 * (cpuSeconds() - cpu));
  }
  return min;
}

/// The straightforward reference: particle by particle, hull by hull, plane by plane.
class PlainPush {
 public:
  explicit PlainPush(std::span<const LivePart> parts) {
    for (const LivePart& part : parts) {
      Hull& hull = hulls_.emplace_back();
      const ConvexHull world = worldHull(part);
      for (const Vec3& v : world.vertices) {
        hull.min = hull.min.cwiseMin(v.cast<float>());
        hull.max = hull.max.cwiseMax(v.cast<float>());
      }
      for (const auto& [a, b, c] : world.triangles) {
        const Vec3& corner = world.vertices[a];
        const Vec3 normal = (world.vertices[b] - corner).cross(world.vertices[c] - corner).normalized();
        hull.planes.push_back({normal.cast<float>(), static_cast<float>(normal.dot(corner))});
      }
    }
  }

  /// @return number of moved particles
  std::size_t push(std::span<Vec3f> positions) const {
    std::size_t moved = 0;
    for (Vec3f& p : positions) {
      bool inside = false;
      for (int round = 0; round < 4 && leaveOne(p); ++round) inside = true;
      moved += inside ? 1 : 0;
    }
    return moved;
  }

 private:
  struct Plane {
    Vec3f normal;
    float offset;
  };
  struct Hull {
    std::vector<Plane> planes;
    Vec3f min = Vec3f::Constant(std::numeric_limits<float>::infinity());
    Vec3f max = Vec3f::Constant(-std::numeric_limits<float>::infinity());
  };

  /// Moves a particle out of the first hull that contains it.
  bool leaveOne(Vec3f& p) const {
    for (const Hull& hull : hulls_) {
      if (p.x() < hull.min.x() || p.y() < hull.min.y() || p.z() < hull.min.z() || p.x() > hull.max.x() ||
          p.y() > hull.max.y() || p.z() > hull.max.z()) {
        continue;
      }
      float highest = -std::numeric_limits<float>::infinity();
      const Plane* nearest = nullptr;
      for (const Plane& plane : hull.planes) {
        const float height = plane.normal.dot(p) - plane.offset;
        if (height > 0.0F) {
          nearest = nullptr;
          break;
        }
        if (height <= highest) continue;
        highest = height;
        nearest = &plane;
      }
      if (nearest == nullptr) continue;
      p += (1e-6F - highest) * nearest->normal;
      return true;
    }
    return false;
  }

  std::vector<Hull> hulls_;
};

/// Particles distributed uniformly in a box.
std::vector<Vec3f> sandbox(const Vec3& center, const Vec3& size, std::size_t count) {
  RandomNumbers random(1);
  std::vector<Vec3f> particles(count);
  for (Vec3f& p : particles) {
    const double x = center.x() + size.x() * (random.unit() - 0.5);
    const double y = center.y() + size.y() * (random.unit() - 0.5);
    const double z = center.z() + size.z() * (random.unit() - 0.5);
    p = Vec3(x, y, z).cast<float>();
  }
  return particles;
}

/// Particles close to the body: each within 5 cm of the bounding box of a part.
std::vector<Vec3f> cloud(std::span<const LivePart> parts, std::size_t count) {
  std::vector<Aabb> boxes;
  for (const LivePart& part : parts) {
    boxes.push_back(boundsOf(worldHull(part).vertices));
    boxes.back().min.array() -= 0.05;
    boxes.back().max.array() += 0.05;
  }
  RandomNumbers random(2);
  std::vector<Vec3f> particles(count);
  for (Vec3f& p : particles) {
    const Aabb& box = boxes[random.bits() % boxes.size()];
    const double x = random.unit();
    const double y = random.unit();
    const double z = random.unit();
    p = (box.min + Vec3(x, y, z).cwiseProduct(box.max - box.min)).cast<float>();
  }
  return particles;
}

/// Sorts by cells of 4 cm, layer by layer.
void sortByCell(std::vector<Vec3f>& particles) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    std::uint64_t key = 0;
    for (const int axis : {1, 2, 0}) {
      key = key << 16U | static_cast<std::uint64_t>(32768.0F + std::floor(particles[i][axis] / 0.04F));
    }
    keys[i] = {key, static_cast<std::uint32_t>(i)};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Vec3f> sorted(particles.size());
  for (std::size_t i = 0; i < keys.size(); ++i) sorted[i] = particles[keys[i].second];
  particles = std::move(sorted);
}

std::uint64_t hashOf(std::span<const Vec3f> positions, std::span<const ParticleTouch> touches) {
  const std::uint64_t hash = XXH3_64bits(positions.data(), positions.size_bytes());
  return XXH3_64bits_withSeed(touches.data(), touches.size_bytes(), hash);
}

/// Number of particles inside a hull by more than a depth [m], by brute force.
std::size_t deeperThan(std::span<const LivePart> parts, std::span<const Vec3f> positions, double depth) {
  std::vector<ConvexHull> hulls;
  std::vector<Aabb> boxes;
  for (const LivePart& part : parts) {
    hulls.push_back(worldHull(part));
    boxes.push_back(boundsOf(hulls.back().vertices));
  }
  std::size_t count = 0;
  for (const Vec3f& position : positions) {
    const Vec3 p = position.cast<double>();
    for (std::size_t h = 0; h < hulls.size(); ++h) {
      if ((p.array() < boxes[h].min.array()).any() || (p.array() > boxes[h].max.array()).any()) continue;
      double highest = -std::numeric_limits<double>::infinity();
      for (const auto& [a, b, c] : hulls[h].triangles) {
        const Vec3& corner = hulls[h].vertices[a];
        const Vec3 normal = (hulls[h].vertices[b] - corner).cross(hulls[h].vertices[c] - corner).normalized();
        highest = std::max(highest, normal.dot(p - corner));
        if (highest > -depth) break;
      }
      if (highest > -depth) continue;
      ++count;
      break;
    }
  }
  return count;
}

void measure(const std::string& name, std::span<const LivePart> parts, const std::vector<Vec3f>& particles,
             int repeats) {
  std::vector<Vec3f> moved;
  const auto restore = [&] { moved = particles; };
  const PlainPush plain(parts);
  const Cost reference = minOf(std::min(repeats, 3), restore, [&] { (void)plain.push(moved); });
  const std::size_t leftByReference = deeperThan(parts, moved, 1e-3);
  for (const int threads : {1, 2}) {
    ParticlePush push = ParticlePush::create({.threads = threads}).value();
    std::span<const ParticleTouch> touches;
    const Cost cost = minOf(repeats, restore, [&] {
      push.prepare(parts, kSecondsOfFrame);
      touches = push.push(moved);
    });
    fmt::print("\"{}\",{},{},{:.3f},{:.1f},{:.1f},{:.1f},{:.1f},{},{},{:016x}\n", name, particles.size(), threads,
               100.0 * static_cast<double>(touches.size()) / static_cast<double>(particles.size()), cost.wall, cost.cpu,
               reference.cpu, reference.cpu / cost.cpu, leftByReference, deeperThan(parts, moved, 1e-3),
               hashOf(moved, touches));
    std::fflush(stdout);
  }
}

int run(const Options& options) {
  Result<Walker> made = makeWalker(options.parts, options.hullVertices);
  if (!made) return fail(made.error());
  LiveBody& body = *made->body;
  const std::vector<std::vector<Affine3>>& frames = made->worldFromModel;

  const std::size_t middle = frames.size() / 2;
  body.update(frames[middle - 1]);
  body.update(frames[middle]);
  std::size_t faces = 0;
  Aabb box;
  for (const LivePart& part : body.parts()) {
    faces += part.shape.triangles.size();
    for (const Vec3& v : part.shape.vertices) box.extend(part.worldFromPart * v);
  }
  fmt::print("# {} parts, {} faces; a frame consists of preparing and pushing\n", body.parts().size(), faces);
  fmt::print(
      "task,particles,threads,inside_percent,wall_ms,cpu_ms,reference_cpu_ms,ratio,reference_deeper_than_1mm,deeper_"
      "than_1mm,hash\n");

  std::fflush(stdout);
  std::vector<Vec3f> particles = sandbox(box.center(), {2.0, 2.2, 2.0}, options.particles);
  measure("box 2 x 2.2 x 2 m, unsorted", body.parts(), particles, options.repeats);
  sortByCell(particles);
  measure("the same, sorted by cell", body.parts(), particles, options.repeats);
  particles = cloud(body.parts(), options.particles);
  measure("within 5 cm of the parts' boxes, unsorted", body.parts(), particles, options.repeats);
  sortByCell(particles);
  measure("the same, sorted by cell", body.parts(), particles, options.repeats);
  return 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  lorica::bench::Options options;
  CLI::App app("Measures pushing particles out of a live body");
  app.add_option("--particles", options.particles, "number of particles")->check(CLI::Range(1000, 100'000'000));
  app.add_option("--parts", options.parts, "parts of the body")->check(CLI::Range(1, 64));
  app.add_option("--hull-vertices", options.hullVertices, "maximum per part")->check(CLI::Range(8, 10'000));
  app.add_option("--repeats", options.repeats, "repeats of each measurement")->check(CLI::Range(1, 100));
  lorica::bench::addInstructions(app);
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(options);
}
