#include "session/contact_events.h"

#include "acd/transfer.h"
#include "collision/world/strike_limit.h"
#include "geometry/counts.h"
#include "geometry/mass_properties.h"
#include "session/session.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

// Frames that are closer in time are repeated ones.
constexpr double kShortestEventSeconds = 0.001;

constexpr double kBodyDensity = 1000.0;  // of water [kg/m^3]

}  // namespace

std::vector<double> partMasses(const Decomposition& decomposition, const Character& character) {
  std::vector<Vec3> points(decomposition.pointCount());
  transfer(decomposition, character.mesh.vertices, points);
  std::vector<double> masses;
  masses.reserve(decomposition.parts.size());
  for (const Part& part : decomposition.parts) {
    masses.push_back(kBodyDensity * std::abs(massProperties(points, part.triangles).volume));
  }
  return masses;
}

ContactEvents::ContactEvents(const Session& session) : time_(session.time()) {
  masses_.reserve(session.avatars().size());
  for (const SessionAvatar& avatar : session.avatars()) {
    masses_.push_back(partMasses(avatar.body().decomposition(), avatar.character()));
  }
}

std::span<const ContactEvent> ContactEvents::update(const Session& session) {
  const double seconds = std::max(session.time() - time_, kShortestEventSeconds);
  time_ = session.time();
  touches_.clear();
  addPropTouches(session);
  addSelfTouches(session, seconds);
  addAvatarTouches(session);
  return tracker_.update(touches_, time_);
}

/// Unites the points of each pair: the deepest one, with the impulse of all.
void ContactEvents::addPropTouches(const Session& session) {
  for (const Contact& contact : session.world().contacts()) {
    const TouchPair pair{TouchKind::kProp, contact.avatar, contact.part, contact.avatar, contact.prop};
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
  for (int a = 0; a < countOf(session.avatars()); ++a) {
    const SessionAvatar& avatar = session.avatar(a);
    const std::span<const LivePart> parts = avatar.body().parts();
    for (const SelfContact& contact : avatar.selfContacts()) {
      const LivePart& first = parts[contact.first];
      const LivePart& second = parts[contact.second];
      const double mass = std::min(massOf(contact.first, a), massOf(contact.second, a));
      touches_.push_back({TouchPair{TouchKind::kSelf, a, contact.first, a, contact.second},
                          avatar.boneAt(contact.first, contact.position),
                          avatar.boneAt(contact.second, contact.position), contact.position, contact.direction,
                          contact.depth,
                          mass * closingSpeed(first, second, contact.position, contact.direction, seconds)});
    }
  }
}

void ContactEvents::addAvatarTouches(const Session& session) {
  const std::ptrdiff_t begin = touches_.size();
  for (const BodyContact& contact : session.avatarContacts()) {
    const SessionAvatar& first = session.avatar(contact.firstBody);
    const SessionAvatar& second = session.avatar(contact.secondBody);
    touches_.push_back(
        {TouchPair{TouchKind::kAvatars, contact.firstBody, contact.firstPart, contact.secondBody, contact.secondPart},
         first.boneAt(contact.firstPart, contact.position), second.boneAt(contact.secondPart, contact.position),
         contact.position, contact.direction, contact.depth, contact.strength});
  }
  std::sort(touches_.begin() + begin, touches_.end(), [](const Touch& a, const Touch& b) { return a.pair < b.pair; });
}

}  // namespace lorica
