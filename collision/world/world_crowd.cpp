// A frame of a crowd. Instead of substeps for the whole world, as short as the fastest part wants them, islands of
// bodies have their own.

#include "collision/world/bullet_math.h"
#include "collision/world/world_impl.h"
#include "geometry/counts.h"
#include "geometry/threads.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>

namespace lorica {
namespace {

// Length of a tick at most [s]. Within one, a prop meets only what it could reach when the tick began.
constexpr double kTickSeconds = 1.0 / 90.0;
// A part that moves less than this in a frame has the same bounds in all ticks [m].
constexpr double kShortPath = 0.03;
// Props that were slow for this long sleep [s].
constexpr btScalar kRestSeconds = 0.5f;
// So do props that were still for this long [s]: slower than this [m/s], [rad/s].
constexpr double kStillSeconds = 0.1;
constexpr btScalar kStillSpeed = 0.003f;
constexpr btScalar kStillSpin = 0.01f;
// A sleeping prop wakes if another that touches it is nearer than this, or faster [m], [m/s].
constexpr btScalar kTouchingDistance = 0.002f;
constexpr double kWakingSpeed = 0.5;
// Contacts are solved until none changes a speed by more than 0.1 mm/s [m^2/s^2]. Most islands have few, and need a
// fraction of the iterations.
constexpr btScalar kSolvedTo = 1e-8f;

btCollisionObject* collisionObject(const btBroadphaseProxy* proxy) {
  return static_cast<btCollisionObject*>(proxy->m_clientObject);
}

/// The two bodies of a pair: a prop that can move comes first if there is one.
struct PairBodies {
  explicit PairBodies(const btBroadphasePair& pair)
      : prop(collisionObject(pair.m_pProxy0)), other(collisionObject(pair.m_pProxy1)) {
    if (prop->isStaticOrKinematicObject()) std::swap(prop, other);
  }
  btCollisionObject* prop;
  btCollisionObject* other;

  [[nodiscard]] bool withPart() const { return other->isKinematicObject(); }
  [[nodiscard]] bool withProp() const { return !other->isStaticOrKinematicObject(); }
};

bool isTouching(const btBroadphasePair& pair, btManifoldArray& manifolds) {
  manifolds.resizeNoInitialize(0);
  if (pair.m_algorithm != nullptr) pair.m_algorithm->getAllContactManifolds(manifolds);
  for (int m = 0; m < manifolds.size(); ++m) {
    for (int i = 0; i < manifolds[m]->getNumContacts(); ++i) {
      if (manifolds[m]->getContactPoint(i).getDistance() < kTouchingDistance) return true;
    }
  }
  return false;
}

/// How fast two balls around bodies approach each other, if they can meet within some time; otherwise 0 [m/s].
/// @param turning  speed of both surfaces by rotation [m/s]
/// @param reach    both radii [m]
double approachOf(const Vec3& apart, const Vec3& velocity, double turning, double reach, double seconds) {
  const double soonest = std::clamp(-apart.dot(velocity) / std::max(velocity.squaredNorm(), 1e-12), 0.0, seconds);
  return (apart + soonest * velocity).norm() <= reach ? velocity.norm() + turning : 0.0;
}

}  // namespace

void Island::clear() {
  props.clear();
  parts.clear();
  pairs.clear();
  joints.clear();
  contacts.clear();
}

void DisjointSets::reset(int count) {
  parents_.resize(count);
  std::iota(parents_.begin(), parents_.end(), 0);
}

int DisjointSets::find(int i) {
  while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
  return i;
}

void DisjointSets::unite(int i, int j) {
  i = find(i);
  j = find(j);
  parents_[std::max(i, j)] = std::min(i, j);
}

void World::Impl::stepCrowd(double seconds) {
  crowd.parts.clear();
  for (const auto& parts : avatars) {
    for (const std::unique_ptr<PartCollider>& part : parts) {
      if (!part->inWorld) continue;
      part->slot = props.size() + crowd.parts.size();
      crowd.parts.push_back(part.get());
    }
  }
  const double ticks = std::max(1.0, std::ceil(seconds / kTickSeconds - 1e-6));
  for (double t = 0.0; t < ticks; ++t) {
    const Tick tick{t / ticks, 1.0 / ticks, seconds};
    setTickBounds(tick);
    wakeTouched(tick);
    findIslands();
    // Islands differ much in size, so a core takes one at a time: the largest that is left.
    std::atomic<std::size_t> next = 0;
    parallelPieces(crowd.islandCount, [&](std::size_t) { stepIsland(crowd.islands[crowd.bySize[next++]], tick); });
    for (std::size_t i = 0; i < crowd.islandCount; ++i) {
      for (const Contact& contact : crowd.islands[i].contacts) noteContact(contacts, contact);
    }
    sleepAtRest(tick.share * seconds);
  }
  // Threads create contacts in any order.
  dispatcher.orderManifolds(*broadphase.getOverlappingPairCache());
}

/// Gives the broad phase all space that parts and props pass in a tick.
void World::Impl::setTickBounds(const Tick& tick) {
  const btVector3 margin(gContactBreakingThreshold, gContactBreakingThreshold, gContactBreakingThreshold);
  const auto set = [&](btRigidBody& body, const btVector3& low, const btVector3& high) {
    broadphase.setAabb(body.getBroadphaseProxy(), low - margin, high + margin, &dispatcher);
  };
  const auto keepsBounds = [&](const PartCollider& part) { return tick.begin > 0.0 && part.sweep.path() < kShortPath; };
  parallelFor(crowd.parts.size(), [&](std::size_t i) {
    PartCollider& part = *crowd.parts[i];
    if (keepsBounds(part)) return;
    const double end = part.sweep.path() < kShortPath ? 1.0 : tick.begin + tick.share;
    btVector3 low, high;
    part.shape.getAabb(part.sweep.at(tick.begin), part.low, part.high);
    part.shape.getAabb(part.sweep.at(end), low, high);
    part.low.setMin(low);
    part.high.setMax(high);
  });
  for (const PartCollider* part : crowd.parts) {
    if (!keepsBounds(*part)) set(*part->body, part->low, part->high);
  }
  for (const PropBody& prop : propBodies) {
    if (!isAwake(*prop.body)) continue;
    btVector3 low, high;
    prop.shape->getAabb(prop.body->getWorldTransform(), low, high);
    const btVector3 travel = prop.body->getLinearVelocity() * (tick.share * tick.seconds);
    const btVector3 none(0, 0, 0);
    btVector3 back = travel, ahead = travel;
    back.setMin(none);
    ahead.setMax(none);
    set(*prop.body, low + back, high + ahead);
  }
}

bool World::Impl::isAwake(const btCollisionObject& body) {
  return body.isActive() && !body.isStaticOrKinematicObject();
}

/// Wakes props that a part or an awake prop touches, or may hit in this tick.
void World::Impl::wakeTouched(const Tick& tick) {
  btBroadphasePairArray& pairs = broadphase.getOverlappingPairCache()->getOverlappingPairArray();
  const auto wakes = [&](btBroadphasePair& pair, const PairBodies& bodies) {
    if (bodies.withPart()) {
      const Sweep& sweep = partOf(*bodies.other).sweep;
      return dispatcher.canTouch(pair, sweep.path() * tick.share);
    }
    const btCollisionObject& awake = isAwake(*bodies.prop) ? *bodies.prop : *bodies.other;
    if (propBodies[awake.getUserIndex()].speed() > kWakingSpeed) return true;
    dispatcher.process(pair, world.getDispatchInfo());
    return isTouching(pair, crowd.manifolds);
  };
  bool withParts = true;  // only once: parts wake the same props again
  for (bool more = true; more; withParts = false) {
    more = false;
    for (int p = 0; p < pairs.size(); ++p) {
      const PairBodies bodies(pairs[p]);
      const bool propAwake = isAwake(*bodies.prop);
      if (bodies.prop->isStaticObject() || (propAwake && !bodies.withProp())) continue;
      if (bodies.withPart() && !withParts) continue;
      if (!bodies.withPart() && propAwake == isAwake(*bodies.other)) continue;
      if (!wakes(pairs[p], bodies)) continue;
      (propAwake ? bodies.other : bodies.prop)->activate();
      more = true;
    }
    for (int j = 0; j < world.getNumConstraints(); ++j) {
      btTypedConstraint& joint = *world.getConstraint(j);
      btRigidBody& a = joint.getRigidBodyA();
      btRigidBody& b = joint.getRigidBodyB();
      if (a.isStaticObject() || b.isStaticObject() || isAwake(a) == isAwake(b)) continue;
      (isAwake(a) ? b : a).activate();
      more = true;
    }
  }
}

void World::Impl::findIslands() {
  btBroadphasePairArray& pairs = broadphase.getOverlappingPairCache()->getOverlappingPairArray();
  const int count = props.size() + crowd.parts.size();
  crowd.sets.reset(count);
  for (int p = 0; p < pairs.size(); ++p) {
    const PairBodies bodies(pairs[p]);
    if (!isAwake(*bodies.prop)) continue;
    if (bodies.withPart()) crowd.sets.unite(bodies.prop->getUserIndex(), partOf(*bodies.other).slot);
    if (isAwake(*bodies.other)) crowd.sets.unite(bodies.prop->getUserIndex(), bodies.other->getUserIndex());
  }
  for (int j = 0; j < world.getNumConstraints(); ++j) {
    const btRigidBody& a = world.getConstraint(j)->getRigidBodyA();
    const btRigidBody& b = world.getConstraint(j)->getRigidBodyB();
    if (isAwake(a) && isAwake(b)) crowd.sets.unite(a.getUserIndex(), b.getUserIndex());
  }

  crowd.islandCount = 0;
  crowd.islandOfSet.assign(count, -1);
  const auto islandOf = [&](int i) -> Island& {
    int& island = crowd.islandOfSet[crowd.sets.find(i)];
    if (island < 0) {
      island = crowd.islandCount++;
      if (crowd.islands.size() < crowd.islandCount) crowd.islands.emplace_back();
      crowd.islands[island].clear();
    }
    return crowd.islands[island];
  };
  for (std::size_t i = 0; i < props.size(); ++i) {
    btRigidBody* body = propBodies[i].body.get();
    if (isAwake(*body)) islandOf(i).props.push_back(body);
  }
  for (PartCollider* part : crowd.parts) {
    if (crowd.islandOfSet[crowd.sets.find(part->slot)] >= 0) islandOf(part->slot).parts.push_back(part);
  }
  for (int p = 0; p < pairs.size(); ++p) {
    const PairBodies bodies(pairs[p]);
    const bool moves = isAwake(*bodies.prop) && (!bodies.withProp() || isAwake(*bodies.other));
    if (moves) islandOf(bodies.prop->getUserIndex()).pairs.push_back(&pairs[p]);
  }
  for (int j = 0; j < world.getNumConstraints(); ++j) {
    btTypedConstraint* joint = world.getConstraint(j);
    const btRigidBody& moves = isAwake(joint->getRigidBodyA()) ? joint->getRigidBodyA() : joint->getRigidBodyB();
    if (isAwake(moves)) islandOf(moves.getUserIndex()).joints.push_back(joint);
  }
  crowd.bySize.resize(crowd.islandCount);
  std::iota(crowd.bySize.begin(), crowd.bySize.end(), std::size_t{0});
  std::sort(crowd.bySize.begin(), crowd.bySize.end(), [&](std::size_t a, std::size_t b) {
    return crowd.islands[a].pairs.size() > crowd.islands[b].pairs.size();
  });
}

/// Length of the island's next substep at most, as longestSubstep() [s].
double World::Impl::longestSubstep(const Island& island, double fraction, double left, double seconds) const {
  double rate = 0.0;
  for (const btBroadphasePair* pair : island.pairs) {
    const PairBodies bodies(*pair);
    if (!bodies.withPart() && !bodies.withProp()) continue;
    const PropBody& prop = propBodies[bodies.prop->getUserIndex()];
    const Vec3 velocity = fromBullet(prop.body->getLinearVelocity());
    const Vec3 position = fromBullet(prop.body->getWorldTransform().getOrigin());
    if (bodies.withPart()) {
      const Sweep& sweep = partOf(*bodies.other).sweep;
      rate = std::max(rate,
                      approachOf(sweep.origin + fraction * sweep.travel - position, sweep.travel / seconds - velocity,
                                 std::abs(sweep.angle) / seconds * sweep.radius + prop.spin(),
                                 sweep.radius + prop.radius + kLongestApproach, left));
    } else {
      const PropBody& other = propBodies[bodies.other->getUserIndex()];
      rate =
          std::max(rate, approachOf(fromBullet(other.body->getWorldTransform().getOrigin()) - position,
                                    fromBullet(other.body->getLinearVelocity()) - velocity, prop.spin() + other.spin(),
                                    prop.radius + other.radius + kLongestApproach, left));
    }
  }
  return kLongestApproach / std::clamp(rate, kLongestApproach / left, kFastestApproach);
}

void World::Impl::stepIsland(Island& island, const Tick& tick) {
  const auto holdsHere = [&](const std::optional<GrabAnchor>& grab) {
    return grab && std::ranges::find(island.props, propBodies[grab->prop].body.get()) != island.props.end();
  };
  std::array<bool, kMaxHands> holds;
  std::ranges::transform(grabs, holds.begin(), holdsHere);
  double left = tick.share * tick.seconds;
  while (left > 0.0) {
    const double fraction = tick.begin + tick.share - left / tick.seconds;
    const double count = std::ceil(left / longestSubstep(island, fraction, left, tick.seconds) - 1e-6);
    const double length = left / std::max(1.0, count);
    for (PartCollider* part : island.parts) movePart(*part, fraction, tick.seconds);
    for (int hand = 0; hand < kMaxHands; ++hand) {
      if (holds[hand]) drawGrabbed(hand, length);
    }
    substep(island, length);
    left = count <= 1.0 ? 0.0 : left - length;
  }
}

void World::Impl::substep(Island& island, double length) {
  const btScalar seconds = length;
  btContactSolverInfo solving = solverInfo(length);
  solving.m_timeStep = seconds;
  solving.m_leastSquaresResidualThreshold = kSolvedTo;
  island.manifolds.resizeNoInitialize(0);
  for (btBroadphasePair* pair : island.pairs) {
    dispatcher.process(*pair, world.getDispatchInfo());
    if (pair->m_algorithm != nullptr) pair->m_algorithm->getAllContactManifolds(island.manifolds);
  }
  for (int m = 0; m < island.manifolds.size(); ++m) {
    closeFastContacts(*island.manifolds[m], solving.m_restitutionVelocityThreshold, seconds);
  }
  for (btCollisionObject* prop : island.props) {
    btRigidBody& body = *btRigidBody::upcast(prop);
    body.applyDamping(seconds);
    body.applyGravity();
  }
  island.solver->solveGroup(island.props.data(), countOf(island.props),
                            island.manifolds.size() > 0 ? &island.manifolds[0] : nullptr, island.manifolds.size(),
                            island.joints.data(), countOf(island.joints), solving, nullptr, &dispatcher);
  for (int m = 0; m < island.manifolds.size(); ++m) collectContacts(*island.manifolds[m], island.contacts);
  for (btCollisionObject* prop : island.props) {
    btRigidBody& body = *btRigidBody::upcast(prop);
    btTransform after;
    body.predictIntegratedTransform(seconds, after);
    body.proceedToTransform(after);
    body.clearForces();
    keepAboveFloor(body);
  }
}

/// Lets props sleep that rest, together with all that they touch.
void World::Impl::sleepAtRest(double seconds) {
  crowd.sets.reset(countOf(props));
  for (std::size_t i = 0; i < crowd.islandCount; ++i) {
    for (const btBroadphasePair* pair : crowd.islands[i].pairs) {
      const PairBodies bodies(*pair);
      if (!bodies.withProp() || !isTouching(*pair, crowd.manifolds)) continue;
      crowd.sets.unite(bodies.prop->getUserIndex(), bodies.other->getUserIndex());
    }
  }
  std::vector<int>& restless = crowd.islandOfSet;
  restless.assign(props.size(), 0);
  const auto eachAwake = [&](const auto& visit) {
    for (std::size_t i = 0; i < props.size(); ++i) {
      PropBody& prop = propBodies[i];
      if (isAwake(*prop.body)) visit(prop, restless[crowd.sets.find(i)]);
    }
  };
  eachAwake([&](PropBody& prop, int& restlessSet) {
    btRigidBody& body = *prop.body;
    body.updateDeactivation(seconds);
    const bool still = body.getLinearVelocity().length2() < kStillSpeed * kStillSpeed &&
                       body.getAngularVelocity().length2() < kStillSpin * kStillSpin;
    prop.stillSeconds = still ? prop.stillSeconds + seconds : 0.0;
    const bool rests = body.getDeactivationTime() > kRestSeconds || prop.stillSeconds > kStillSeconds;
    if (!rests || body.getActivationState() == DISABLE_DEACTIVATION) restlessSet = 1;
  });
  eachAwake([&](PropBody& prop, const int& restlessSet) {
    if (restlessSet != 0) return;
    prop.stillSeconds = 0.0;
    btRigidBody& body = *prop.body;
    body.setActivationState(ISLAND_SLEEPING);
    body.setLinearVelocity(btVector3(0, 0, 0));
    body.setAngularVelocity(btVector3(0, 0, 0));
  });
}

}  // namespace lorica
