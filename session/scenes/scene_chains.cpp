#include "session/scenes/scene_chains.h"

#include "geometry/counts.h"
#include "session/scenes/scene_element.h"
#include "session/scenes/scene_file.h"

#include <fmt/format.h>

namespace lorica {
namespace {

constexpr double kFarthest = 50.0;   // maximum of each coordinate [m]
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
  element.vector("from", -kFarthest, kFarthest, chain.from);
  element.vector("to", -kFarthest, kFarthest, chain.to);
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
  for (const double end : {-0.5, 0.5}) {
    scene.links.push_back({a, b, chain.joint(joint) + end * chain.width * side});
  }
}

}  // namespace

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
