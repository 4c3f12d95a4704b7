#include "session/contact_events.h"

#include "acd/transfer.h"
#include "collision/world/strike_limit.h"
#include "geometry/mass_properties.h"
#include "session/session.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

// Frames that are closer in time are repeated ones.
constexpr double kShortestFrameSeconds = 0.001;

std::vector<double> massesOf(const Decomposition& decomposition, const Character& character) {
  std::vector<Vec3> points(static_cast<std::size_t>(decomposition.pointCount()));
  transfer(decomposition, character.mesh.vertices, points);
  std::vector<double> masses;
  masses.reserve(decomposition.parts.size());
  for (const Part& part : decomposition.parts) {
    masses.push_back(ContactEvents::kBodyDensity * std::abs(massProperties(points, part.triangles).volume));
  }
  return masses;
}

}  // namespace

ContactEvents::ContactEvents(const Session& session)
    : masses_(massesOf(session.body().decomposition(), session.character())),
      bones_(session.body().decomposition(), session.character()),
      time_(session.time()) {}

std::span<const ContactEvent> ContactEvents::update(const Session& session) {
  const double seconds = std::max(session.time() - time_, kShortestFrameSeconds);
  time_ = session.time();
  touches_.clear();
  addPropTouches(session);
  addSelfTouches(session, seconds);
  return tracker_.update(touches_, time_);
}

/// Unites the points of each pair: the deepest one, with the impulse of all.
void ContactEvents::addPropTouches(const Session& session) {
  for (const Contact& contact : session.world().contacts()) {
    const TouchPair pair{TouchKind::kProp, 0, contact.part, 0, contact.prop};
    if (touches_.empty() || touches_.back().pair != pair) {
      touches_.push_back({pair, contact.bone, kNoJoint, contact.point, contact.normal, contact.depth, contact.impulse});
      continue;
    }
    Touch& touch = touches_.back();
    touch.strength += contact.impulse;
    if (contact.depth <= touch.depth) continue;
    touch.bone = contact.bone;
    touch.point = contact.point;
    touch.normal = contact.normal;
    touch.depth = contact.depth;
  }
}

void ContactEvents::addSelfTouches(const Session& session, double seconds) {
  const std::span<const LivePart> parts = session.body().parts();
  for (const SelfContact& contact : session.selfContacts()) {
    const LivePart& first = parts[contact.first];
    const LivePart& second = parts[contact.second];
    const double mass = std::min(masses_[contact.first], masses_[contact.second]);
    touches_.push_back({TouchPair{TouchKind::kSelf, 0, contact.first, 0, contact.second},
                        bones_.at(first, contact.position), bones_.at(second, contact.position), contact.position,
                        contact.direction, contact.depth,
                        mass * closingSpeed(first, second, contact.position, contact.direction, seconds)});
  }
}

}  // namespace lorica
