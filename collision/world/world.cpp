#include "collision/world/world.h"

#include "collision/particles/particles.h"
#include "collision/world/bullet_math.h"
#include "collision/world/prop_overlaps.h"
#include "collision/world/strike_limit.h"
#include "collision/world/world_impl.h"
#include "geometry/counts.h"
#include "geometry/result.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <tuple>
#include <utility>

namespace lorica {
namespace {

constexpr double kSamePosition = 0.02;
// 2,000 props in a heap have some 12,000; each costs up to 4 kB and 20 us a substep.
constexpr int kMaxPairs = 40'000;

}  // namespace

bool PairLimit::needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const {
  if ((a->m_collisionFilterGroup & b->m_collisionFilterMask) == 0) return false;
  if ((b->m_collisionFilterGroup & a->m_collisionFilterMask) == 0) return false;
  const bool withPart = ((a->m_collisionFilterGroup | b->m_collisionFilterGroup) & kPartGroup) != 0;
  return pairs_.getNumOverlappingPairs() < (withPart ? 2 * kMaxPairs : kMaxPairs);
}

World::Impl::Impl(const Settings& s) : settings(s) {
  LORICA_CHECK(settings.substepSeconds > 0.0, "a world needs a substep length above zero");
  // Without polyhedral features a pair yields one point at a time; tilting the shapes slightly finds the others at
  // once, so that a box rests on a hull that loses its contacts with each change of its shape.
  configuration.setConvexConvexMultipointIterations();
  configuration.setPlaneConvexMultipointIterations();
  world.getDispatchInfo().m_deterministicOverlappingPairs = true;
  broadphase.getOverlappingPairCache()->setOverlapFilterCallback(&pairLimit);
  btContactSolverInfo& info = world.getSolverInfo();
  info.m_solverMode &= ~SOLVER_RANDMIZE_ORDER;
  // Overlaps are resolved by position correction, not by velocity: a deforming hull must not kick props. Only the first
  // two millimetres are resolved by velocity, at most 0.1 m/s, because this makes stacks more stable.
  info.m_splitImpulse = 1;
  info.m_splitImpulsePenetrationThreshold = -0.002f;
  info.m_numIterations = 20;
  info.m_leastSquaresResidualThreshold = 1e-12f;  // stop if no contact changes a speed by more than 1 um/s
  world.setGravity(toBullet(settings.gravity));

  btRigidBody::btRigidBodyConstructionInfo construction(0.0f, nullptr, &floorShape);
  construction.m_friction = 1.0f;  // Bullet multiplies both values, so the prop's value counts
  construction.m_restitution = 1.0f;
  floor = std::make_unique<btRigidBody>(construction);
  if (settings.floor) world.addRigidBody(floor.get(), kFloorGroup, kPropGroup);
}

World::Impl::~Impl() {
  for (int hand = 0; hand < kMaxHands; ++hand) release(hand);
  for (std::size_t avatar = 0; avatar < avatars.size(); ++avatar) setPartCount(avatar, 0);
  for (const std::unique_ptr<btTypedConstraint>& link : links) world.removeConstraint(link.get());
  for (PropBody& prop : propBodies) world.removeRigidBody(prop.body.get());
  if (settings.floor) world.removeRigidBody(floor.get());
}

void World::Impl::addBody(const PropBody& body, bool isStatic) {
  if (isStatic) {
    world.addRigidBody(body.body.get(), kFloorGroup, kPropGroup);
  } else {
    world.addRigidBody(body.body.get(), kPropGroup, kFloorGroup | kPropGroup | kPartGroup);
  }
}

void World::Impl::resolveInitialOverlaps(std::span<const std::span<const LivePart>> present) {
  if (overlapsResolved || !settings.resolvesOverlaps) return;
  std::vector<LivePart> parts;
  for (const std::span<const LivePart> avatar : present) parts.insert(parts.end(), avatar.begin(), avatar.end());
  if (parts.empty()) return;
  overlapsResolved = true;
  const std::vector<Vec3> moves = resolveOverlaps(parts, props);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    if (moves[i].isZero() || std::find(thrown.begin(), thrown.end(), static_cast<int>(i)) != thrown.end()) continue;
    Prop prop = props[i];
    prop.worldFromProp.pretranslate(moves[i]);
    replaceProp(i, prop);
  }
}

/// Length of the next substep: the usual one, or shorter if a part and a prop may meet in it at high speed.
/// @param fraction  of the frame that is done
/// @param usual     length of a substep if nothing is fast [s]
/// @param seconds   of the frame
double World::Impl::longestSubstep(double fraction, double usual, double seconds) const {
  double fastestProp = 0.0;
  for (const PropBody& prop : propBodies) fastestProp = std::max(fastestProp, prop.speed());
  double rate = kLongestApproach / usual;  // fastest approach for which the usual length suffices [m/s]
  const auto check = [&](const PartCollider& part) {
    const Sweep& sweep = part.sweep;
    const double turning = std::abs(sweep.angle) / seconds * sweep.radius;
    if (!part.inWorld || sweep.travel.norm() / seconds + turning + fastestProp <= rate) return;
    const Vec3 position = sweep.origin + fraction * sweep.travel;
    const auto meet = [&](const PropBody& prop) {
      const Vec3 velocity = sweep.travel / seconds - fromBullet(prop.body->getLinearVelocity());
      const double speed = std::min(velocity.norm() + turning + prop.spin(), kFastestApproach);
      if (speed <= rate) return;
      // Can the bounding spheres, on straight paths, meet within a usual substep?
      const Vec3 apart = position - fromBullet(prop.body->getWorldTransform().getOrigin());
      const double soonest = std::clamp(-apart.dot(velocity) / std::max(velocity.squaredNorm(), 1e-12), 0.0, usual);
      if ((apart + soonest * velocity).norm() <= sweep.radius + prop.radius + kLongestApproach) rate = speed;
    };
    for (const PropBody& prop : propBodies) meet(prop);
  };
  for (const auto& parts : avatars) {
    for (const std::unique_ptr<PartCollider>& part : parts) check(*part);
  }
  return kLongestApproach / rate;
}

void World::Impl::collectContacts(const btPersistentManifold& manifold, std::vector<Contact>& contacts) {
  const btCollisionObject* a = manifold.getBody0();
  const btCollisionObject* b = manifold.getBody1();
  if (a->isKinematicObject() == b->isKinematicObject()) return;
  const bool partIsA = a->isKinematicObject();
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    const btManifoldPoint& point = manifold.getContactPoint(i);
    if (point.getDistance() > 0.0f && point.getAppliedImpulse() <= 0.0f) continue;
    Contact contact;
    contact.avatar = (partIsA ? a : b)->getUserIndex3();
    contact.part = (partIsA ? a : b)->getUserIndex();
    contact.prop = (partIsA ? b : a)->getUserIndex();
    contact.point = fromBullet(partIsA ? point.getPositionWorldOnA() : point.getPositionWorldOnB());
    contact.normal = fromBullet(partIsA ? -point.m_normalWorldOnB : point.m_normalWorldOnB);
    contact.depth = -point.getDistance();
    contact.impulse = point.getAppliedImpulse();
    noteContact(contacts, contact);
  }
}

// Parts are kinematic and may press a prop into the floor. Pressed in by more than half, it would fall through.
void World::Impl::keepAboveFloor(btRigidBody& body) const {
  const btVector3 position = body.getWorldTransform().getOrigin();
  if (!settings.floor || body.isStaticObject() || position.y() >= 0.0f) return;
  btTransform lifted = body.getWorldTransform();
  lifted.setOrigin(btVector3(position.x(), 0.0f, position.z()));
  body.setWorldTransform(lifted);
  const btVector3 velocity = body.getLinearVelocity();
  body.setLinearVelocity(btVector3(velocity.x(), std::max(velocity.y(), 0.0f), velocity.z()));
}

void World::Impl::noteContact(std::vector<Contact>& contacts, const Contact& contact) {
  for (Contact& known : contacts) {
    if (known.part != contact.part || known.prop != contact.prop || known.avatar != contact.avatar) continue;
    if ((known.point - contact.point).squaredNorm() > kSamePosition * kSamePosition) continue;
    const double impulse = known.impulse + contact.impulse;
    if (contact.depth >= known.depth) known = contact;
    known.impulse = impulse;
    return;
  }
  contacts.push_back(contact);
}

void World::Impl::readProps() {
  for (std::size_t i = 0; i < props.size(); ++i) propBodies[i].read(props[i]);
}

std::vector<ParticleBody>& World::Impl::bodiesBefore() {
  met.clear();
  for (std::size_t i = 0; i < props.size(); ++i) met.push_back(propBodies[i].forParticles(props[i]));
  return met;
}

std::span<ParticleBody> World::Impl::bodiesAfter(double seconds) {
  for (std::size_t i = 0; i < met.size(); ++i) {
    met[i].to = propBodies[i].motion();
    // A body that sleeps has not fallen, and must not rise as if it had no weight.
    if (!isAwake(*propBodies[i].body) && met[i].inverseMass > 0.0) met[i].to.velocity += seconds * settings.gravity;
  }
  return met;
}

void World::Impl::takeBodies() {
  for (std::size_t i = 0; i < met.size(); ++i) {
    if (!met[i].pushed || met[i].inverseMass == 0.0) continue;
    propBodies[i].move(met[i].to);
    keepAboveFloor(*propBodies[i].body);
    propBodies[i].read(props[i]);
  }
}

/// Contact settings for a substep. One of maximum length corrects a fifth of each overlap and of each joint's position
/// error; shorter substeps correct less. Otherwise a chain stretched by an arm would snap back faster in shorter
/// substeps.
btContactSolverInfo World::Impl::solverInfo(double length) {
  btContactSolverInfo info = world.getSolverInfo();
  info.m_erp = info.m_erp2 = 0.2 * std::min(1.0, length / settings.substepSeconds);
  return info;
}

/// Steps all bodies with the same substeps.
void World::Impl::stepTogether(double seconds) {
  const double usual = seconds / std::max(1.0, std::ceil(seconds / settings.substepSeconds - 1e-6));
  double done = 0.0;  // of the frame
  while (done < 1.0) {
    // The rest of the frame is split into equal substeps.
    const double longest = longestSubstep(done, usual, seconds);
    const double left = std::max(1.0, std::ceil((1.0 - done) * seconds / longest - 1e-6));
    const double length = (1.0 - done) * seconds / left;
    for (const auto& parts : avatars) {
      for (const std::unique_ptr<PartCollider>& part : parts) {
        if (part->inWorld) movePart(*part, done, seconds);
      }
    }
    world.getSolverInfo() = solverInfo(length);
    for (int hand = 0; hand < kMaxHands; ++hand) drawGrabbed(hand, length);
    world.stepSimulation(length, 0);
    for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
      collectContacts(*dispatcher.getManifoldByIndexInternal(m), contacts);
    }
    for (const PropBody& prop : propBodies) keepAboveFloor(*prop.body);
    done = left == 1.0 ? 1.0 : done + (1.0 - done) / left;
  }
}

World::World() : World(Settings()) {}
World::World(const Settings& settings) : impl_(std::make_unique<Impl>(settings)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

int World::addProp(const Prop& prop) {
  std::vector<Prop>& props = impl_->props;
  LORICA_CHECK(props.size() < kMaxProps, "too many props for the broad phase");
  const PropBody* same = nullptr;
  if (prop.mesh) {
    const auto found = std::ranges::find(props, prop.mesh, &Prop::mesh);
    if (found != props.end()) same = &impl_->propBodies[found - props.begin()];
  }
  impl_->propBodies.push_back(makePropBody(prop, countOf(props), same));
  impl_->addBody(impl_->propBodies.back(), prop.mass == 0.0);
  props.push_back(prop);
  return countOf(props) - 1;
}

void World::addLink(int a, int b, const Vec3& position) {
  if (a == kWorldItself) std::swap(a, b);
  LORICA_CHECK(impl_->isProp(a) && (b == kWorldItself || impl_->isProp(b)) && a != b,
               "a link connects a prop to another prop or to the world");
  for (const int t : impl_->thrown) {
    LORICA_CHECK(t != a && t != b, "thrown props cannot have links: they may be replaced");
  }
  btRigidBody& first = *impl_->propBodies[a].body;
  const btVector3 inFirst = first.getWorldTransform().inverse() * toBullet(position);
  std::unique_ptr<btPoint2PointConstraint> link;
  if (b == kWorldItself) {
    link = std::make_unique<btPoint2PointConstraint>(first, inFirst);
  } else {
    btRigidBody& second = *impl_->propBodies[b].body;
    link = std::make_unique<btPoint2PointConstraint>(first, second, inFirst,
                                                     second.getWorldTransform().inverse() * toBullet(position));
  }
  impl_->world.addConstraint(link.get(), true);
  impl_->links.push_back(std::move(link));
}

Result<void> World::setParticles(const ParticleSettings& settings) {
  LORICA_TRY(Particles made, Particles::create(settings, impl_->bodiesBefore()));
  particles_ = std::make_unique<Particles>(std::move(made));
  return {};
}

void World::settle(std::span<const std::span<const LivePart>> avatars) {
  if (particles_) particles_->settle(partsForParticles(avatars), impl_->bodiesBefore());
}

void World::watchSettling(std::function<bool(int frame, int frames)> watch) {
  if (particles_) particles_->watchSettling(std::move(watch));
}

void World::stepAvatars(std::span<const std::span<const LivePart>> avatars, double seconds) {
  LORICA_CHECK(seconds >= 0.0 && std::isfinite(seconds), "the length of a step must be finite and at least zero");
  impl_->contacts.clear();
  impl_->resolveInitialOverlaps(avatars);
  impl_->setPartCounts(avatars);
  impl_->findReaches(seconds);
  impl_->takeParts(avatars, seconds);
  impl_->followSurfaces();
  if (particles_) impl_->bodiesBefore();

  if (seconds > 0.0) {
    if (impl_->crowd.present) {
      impl_->stepCrowd(seconds);
    } else {
      impl_->stepTogether(seconds);
    }
  }
  for (const auto& parts : impl_->avatars) {
    for (const std::unique_ptr<PartCollider>& part : parts) {
      if (part->inWorld) part->body->setWorldTransform(part->sweep.at(1.0));
    }
  }

  std::sort(impl_->contacts.begin(), impl_->contacts.end(), [](const Contact& a, const Contact& b) {
    return std::make_tuple(a.avatar, a.part, a.prop, a.point.x(), a.point.y(), a.point.z()) <
           std::make_tuple(b.avatar, b.part, b.prop, b.point.x(), b.point.y(), b.point.z());
  });
  impl_->readProps();
  particleSeconds_ = 0.0;
  if (particles_ && seconds > 0.0) {
    const auto begin = std::chrono::steady_clock::now();
    particles_->step(partsForParticles(avatars), seconds, impl_->bodiesAfter(seconds));
    impl_->takeBodies();
    particleSeconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
}

/// The parts of all avatars in one row; copied if there are several avatars.
std::span<const LivePart> World::partsForParticles(std::span<const std::span<const LivePart>> avatars) {
  if (avatars.size() == 1) return avatars.front();
  std::size_t count = 0;
  for (const std::span<const LivePart> avatar : avatars) {
    if (allParts_.size() < count + avatar.size()) allParts_.resize(count + avatar.size());
    std::copy(avatar.begin(), avatar.end(), allParts_.begin() + count);
    count += avatar.size();
  }
  return std::span(allParts_).first(count);
}

bool World::hasFloor() const {
  return impl_->settings.floor;
}

std::span<const Prop> World::props() const {
  return impl_->props;
}
std::span<const Contact> World::contacts() const {
  return impl_->contacts;
}
std::span<Contact> World::contacts() {
  return impl_->contacts;
}

}  // namespace lorica
