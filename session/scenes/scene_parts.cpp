#include "session/scenes/scene_parts.h"

#include "geometry/counts.h"
#include "geometry/work_budgets.h"
#include "session/scenes/scene_file.h"

#include <fmt/format.h>

namespace lorica {
namespace {

constexpr double kFarthestFill = 50.0;  // maximum of each coordinate [m]

void readFill(SceneElement& element, ParticleSettings& settings) {
  element.allow({"at", "size", "count"});
  ParticleSettings::Fill fill;
  element.need("at", "the position of its centre in metres");
  element.need("size", "width, height and depth in metres");
  element.vector("at", -kFarthestFill, kFarthestFill, fill.middle);
  element.vector("size", 0.01, 20.0, fill.size);
  element.integer("count", 1, kMaxParticles, fill.max);
  settings.fills.push_back(fill);
}

void readPour(SceneElement& element, ParticleSettings& settings) {
  element.allow({"at", "radius", "rate", "count", "velocity"});
  ParticleSettings::Pour pour;
  element.need("at", "the position of its centre in metres");
  element.need("count", "the number of particles");
  element.vector("at", -kFarthestFill, kFarthestFill, pour.middle);
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
    element.vector(key, -kFarthestFill, kFarthestFill, key[0] == 'f' ? from : to);
  }
  for (const Eigen::Index axis : {0, 2}) {
    if (to[axis] - from[axis] >= 4.0 * settings.radius) continue;
    element.fail("to", fmt::format("{:g}", to[axis]),
                 fmt::format("at least {:g}, so that two particles fit", from[axis] + 4.0 * settings.radius));
  }
  settings.walls = Aabb{from, to};
}

constexpr double kPlankShare = 0.9;  // length of a plank, of the distance from one to the next

/// A row of links from one position to another.
struct Chain {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  int links = 1;
  double radius = 0.02, width = 0.0, sag = 0.0;  // [m]; width 0 = capsules, otherwise planks
  bool bothEnds = false;

  [[nodiscard]] Vec3 step() const { return (to - from) / links; }
  /// Joint i of links + 1: on a parabola that hangs by the sag below the line.
  [[nodiscard]] Vec3 joint(int i) const {
    const double t = static_cast<double>(i) / links;
    const Vec3 straight = from + i * step();
    return sag == 0.0 ? straight : Vec3(straight - 4.0 * sag * t * (1.0 - t) * Vec3::UnitY());
  }
};

Chain readChainShape(SceneElement& element) {
  Chain chain;
  for (const char* key : {"from", "to"}) element.need(key, "a position in metres");
  element.need("links", "the number of links");
  element.vector("from", -kFarthestFill, kFarthestFill, chain.from);
  element.vector("to", -kFarthestFill, kFarthestFill, chain.to);
  element.integer("links", 1, 200, chain.links);
  element.number("radius", 0.005, 1.0, chain.radius);
  element.number("width", 0.01, 20.0, chain.width);
  element.number("sag", 0.0, 20.0, chain.sag);
  if (element.has("hung")) {
    const SceneJson& hung = element.at("hung");
    chain.bothEnds = hung == "both";
    if (!chain.bothEnds && hung != "from") element.fail("hung", shownInScene(hung), "\"from\" or \"both\"");
  }
  const double length = chain.step().norm();
  if (length < 2.0 * chain.radius) {
    element.fail("links", fmt::format("links of {:.3g} m", length), "links at least twice as long as their radius");
  }
  return chain;
}

/// The rotation of a link: its y axis is along the chain, and the x axis of a plank is level.
Quat linkRotation(const Vec3& step, bool plank) {
  if (!plank) return rotationBetween(Vec3::UnitY(), step);
  const Vec3 along = step.normalized();
  const Vec3 level = along.cross(Vec3::UnitY());
  const Vec3 side = level.norm() > 1e-6 ? level.normalized() : Vec3::UnitX();
  Mat3 axes;
  axes << side, along, side.cross(along);
  return Quat(axes);
}

/// Links a to b at a joint of the chain: capsules by a ball joint, planks by one at either side.
void addLinks(const Chain& chain, int a, int b, int joint, const Vec3& side, SceneFile& scene) {
  if (chain.width == 0.0) return scene.links.push_back({a, b, chain.joint(joint)});
  for (const double end : {-0.5, 0.5}) scene.links.push_back({a, b, chain.joint(joint) + end * chain.width * side});
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

void addChain(SceneElement& element, Prop link, std::size_t maxProps, SceneFile& scene) {
  const Chain chain = readChainShape(element);
  if (element.failed()) return;
  const bool plank = chain.width > 0.0;
  link.shape = plank ? PropShape::kBox : PropShape::kCapsule;
  int before = kWorldItself;
  Vec3 side = Vec3::UnitX();
  for (int i = 0; i < chain.links && scene.props.size() <= maxProps; ++i) {
    const bool straight = chain.sag == 0.0;
    const Vec3 step = straight ? chain.step() : Vec3(chain.joint(i + 1) - chain.joint(i));
    const Vec3 middle = straight ? Vec3(chain.from + (i + 0.5) * step) : Vec3(chain.joint(i) + 0.5 * step);
    const Quat rotation = linkRotation(step, plank);
    side = rotation * Vec3::UnitX();
    link.halfExtents = plank ? Vec3(0.5 * chain.width, 0.5 * kPlankShare * step.norm(), chain.radius)
                             : Vec3(chain.radius, 0.5 * step.norm(), chain.radius);
    link.worldFromProp = Eigen::Translation3d(middle) * rotation;
    const int index = countOf(scene.props);
    scene.props.push_back(link);
    addLinks(chain, index, before, i, side, scene);
    before = index;
  }
  if (chain.bothEnds) addLinks(chain, before, kWorldItself, chain.links, side, scene);
}

}  // namespace lorica
