#include "session/scenes/scene_particles.h"

#include "geometry/work_budgets.h"

#include <fmt/format.h>

namespace lorica {
namespace {

constexpr double kFarthest = 50.0;  // maximum of each coordinate [m]

void readFill(SceneElement& element, ParticleSettings& settings) {
  element.allow({"at", "size", "count"});
  ParticleSettings::Fill fill;
  element.need("at", "the position of its centre in metres");
  element.need("size", "width, height and depth in metres");
  element.vector("at", -kFarthest, kFarthest, fill.middle);
  element.vector("size", 0.01, 20.0, fill.size);
  element.integer("count", 1, kMaxParticles, fill.max);
  settings.fills.push_back(fill);
}

void readPour(SceneElement& element, ParticleSettings& settings) {
  element.allow({"at", "radius", "rate", "count", "velocity"});
  ParticleSettings::Pour pour;
  element.need("at", "the position of its centre in metres");
  element.need("count", "the number of particles");
  element.vector("at", -kFarthest, kFarthest, pour.middle);
  element.number("radius", 0.01, 5.0, pour.radius);
  element.number("rate", 1.0, 1e6, pour.rate);
  element.integer("count", 1, kMaxParticles, pour.count);
  element.vector("velocity", -4.0, 4.0, pour.velocity);
  settings.pours.push_back(pour);
}

void readWalls(SceneElement element, ParticleSettings& settings) {
  element.allow({"from", "to"});
  Vec3 from = Vec3::Constant(-1.0), to = Vec3::Constant(1.0);
  for (const char* key : {"from", "to"}) {
    element.need(key, "a corner in metres");
    element.vector(key, -kFarthest, kFarthest, key[0] == 'f' ? from : to);
  }
  for (const Eigen::Index axis : {0, 2}) {
    if (to[axis] - from[axis] >= 4.0 * settings.radius) continue;
    element.fail("to", fmt::format("{:g}", to[axis]),
                 fmt::format("at least {:g}, so that two particles fit", from[axis] + 4.0 * settings.radius));
  }
  settings.walls = Aabb{from, to};
}

}  // namespace

std::optional<ParticleSettings> readParticles(SceneElement& root, const ParticleSettings& settings) {
  const bool sand = root.has("grains"), water = root.has("water");
  if (!sand && !water) return std::nullopt;
  if (sand && water) root.fail("water", "both grains and water", "one of them");
  ParticleSettings read = settings;
  SceneElement element = root.child(sand ? "grains" : "water");
  if (sand) {
    read.kind = ParticleSettings::Kind::kSand;
    element.allow({"radius", "friction", "color", "settle", "walls", "fill", "pour"});
    element.number("radius", 0.004, 0.1, read.radius);
    element.number("friction", 0.0, 2.0, read.friction);
  } else {
    read.kind = ParticleSettings::Kind::kWater;
    read.color = Vec3f(0.06f, 0.22f, 0.42f);
    element.allow({"spacing", "viscosity", "color", "settle", "walls", "fill", "pour"});
    double spacing = 0.02;
    element.number("spacing", 0.008, 0.2, spacing);
    read.radius = 0.5 * spacing;
    element.number("viscosity", 0.0, 1.0, read.viscosity);
  }
  element.color("color", read.color);
  element.number("settle", 0.0, 20.0, read.settleSeconds);
  if (element.has("walls")) readWalls(element.child("walls"), read);
  element.each("fill", [&](SceneElement& fill) { readFill(fill, read); });
  element.each("pour", [&](SceneElement& pour) { readPour(pour, read); });
  if (read.fills.empty() && read.pours.empty()) element.need("fill", "a list of boxes, or a list \"pour\"");
  if (read.fills.size() + read.pours.size() > kMaxParticleSources) {
    element.fail("", "more sources", fmt::format("at most {}", kMaxParticleSources));
  }
  return read;
}

}  // namespace lorica
