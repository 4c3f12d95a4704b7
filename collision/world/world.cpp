#include "collision/world/world.h"

#include "collision/world/bullet_math.h"
#include "collision/world/resolve_overlaps.h"
#include "collision/world/strike_limit.h"
#include "collision/world/world_impl.h"
#include "geometry/result.h"

#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <tuple>
#include <utility>

namespace lorica {
namespace {

// Hulls are inflated by this so that GJK sees touching shapes as separate. Boxes and balls have their margin inside.
constexpr btScalar kPartMargin = 0.001f;
// Maximum distance over which a contact follows the hull's surface from frame to frame, and the height above the
// surface from which the new position is searched.
constexpr btScalar kFollowed = 0.002f;
constexpr btScalar kLookFrom = 0.004f;
constexpr btScalar kSameNormal = 0.99f;  // cosine
// A part and a prop that may meet approach by at most this much in a substep. The thinnest pair that is guaranteed to
// collide, 2 cm and 4 cm, has half thicknesses of 3 cm together.
constexpr double kLongestApproach = 0.025;
// Faster approaches get no shorter substeps.
constexpr double kFastestApproach = 2.0 * kTeleportSpeed;
constexpr double kSamePosition = 0.02;
// 2,000 props in a heap have some 12,000; each costs up to 4 kB and 20 us a substep.
constexpr int kMaxPairs = 40'000;

Sweep sweepOf(const LivePart& part, double seconds) {
  const Isometry3& begin = part.previousWorldFromPart;
  const Isometry3& end = part.worldFromPart;
  const Eigen::AngleAxisd turn(Quat(Mat3(end.linear() * begin.linear().transpose())).normalized());

  Sweep sweep;
  sweep.origin = begin.translation();
  sweep.rotation = Quat(begin.linear());
  sweep.travel = end.translation() - begin.translation();
  sweep.axis = turn.axis();
  sweep.angle = turn.angle();

  double radiusSq = 0.0;
  for (const Vec3& p : part.shape.vertices) radiusSq = std::max(radiusSq, p.squaredNorm());
  sweep.radius = std::sqrt(radiusSq);
  const double path = sweep.travel.norm() + std::abs(sweep.angle) * sweep.radius;
  if (path > kTeleportSpeed * seconds) {
    sweep.origin = end.translation();
    sweep.rotation = Quat(end.linear());
    sweep.travel = Vec3::Zero();
    sweep.angle = 0.0;
  }
  if (part.trust < 1.0) {
    sweep.strength = std::min(1.0, strikeLimit(part.trust) * seconds / std::max(path, 1e-9));
  }
  return sweep;
}

/// Moves a contact's position to the part's new hull.
/// @param normal    in the part's frame, outwards, unit
/// @param position  in the part's frame, on the inflated hull of the previous frame
/// @return false if the hull is no longer near
bool follow(const PartShape& shape, const btVector3& normal, btVector3& position) {
  const btSphereShape point(0.0f);
  const btVector3 above = position + kLookFrom * normal;
  btGjkEpaSolver2::sResults results;
  if (!btGjkEpaSolver2::Distance(&shape, btTransform::getIdentity(), &point,
                                 btTransform(btMatrix3x3::getIdentity(), above), -normal, results)) {
    return false;
  }
  const btVector3 up = (above - results.witnesses[0]) / results.distance;
  const btScalar moved = results.distance - shape.getMargin() - kLookFrom;
  if (std::abs(moved) > kFollowed || up.dot(normal) < kSameNormal) return false;
  position = results.witnesses[0] + shape.getMargin() * up;
  return true;
}

}  // namespace

btTransform Sweep::at(double fraction) const {
  return toBullet(Quat(Eigen::AngleAxisd(fraction * angle, axis)) * rotation, origin + fraction * travel);
}

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
  release();
  setPartCount(0);
  for (const std::unique_ptr<btTypedConstraint>& link : links) world.removeConstraint(link.get());
  for (PropBody& prop : propBodies) world.removeRigidBody(prop.body.get());
  if (settings.floor) world.removeRigidBody(floor.get());
}

void World::Impl::addProp(const Prop& prop) {
  LORICA_CHECK(props.size() < kMaxBodies / 2, "too many props for the broad phase");
  propBodies.push_back(makePropBody(prop, static_cast<int>(props.size())));
  addBody(propBodies.back(), prop.mass == 0.0);
  props.push_back(prop);
}

void World::Impl::addBody(const PropBody& body, bool isStatic) {
  if (isStatic) {
    world.addRigidBody(body.body.get(), kFloorGroup, kPropGroup);
  } else {
    world.addRigidBody(body.body.get(), kPropGroup, kFloorGroup | kPropGroup | kPartGroup);
  }
}

void World::Impl::addLink(int a, int b, const Vec3& position) {
  if (a == kWorldItself) std::swap(a, b);
  LORICA_CHECK(isProp(a) && (b == kWorldItself || isProp(b)) && a != b,
               "a link connects a prop to another prop or to the world");
  for (const int t : thrown) LORICA_CHECK(t != a && t != b, "thrown props cannot have links: they may be replaced");
  btRigidBody& first = *propBodies[a].body;
  const btVector3 inFirst = first.getWorldTransform().inverse() * toBullet(position);
  std::unique_ptr<btPoint2PointConstraint> link;
  if (b == kWorldItself) {
    link = std::make_unique<btPoint2PointConstraint>(first, inFirst);
  } else {
    btRigidBody& second = *propBodies[b].body;
    link = std::make_unique<btPoint2PointConstraint>(first, second, inFirst,
                                                     second.getWorldTransform().inverse() * toBullet(position));
  }
  world.addConstraint(link.get(), true);
  links.push_back(std::move(link));
}

void World::Impl::resolveInitialOverlaps(std::span<const LivePart> avatar) {
  if (overlapsResolved || avatar.empty()) return;
  overlapsResolved = true;
  if (!settings.resolvesOverlaps) return;
  const std::vector<Vec3> moves = resolveOverlaps(avatar, props);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    if (moves[i].isZero() || std::find(thrown.begin(), thrown.end(), static_cast<int>(i)) != thrown.end()) continue;
    Prop prop = props[i];
    prop.worldFromProp.pretranslate(moves[i]);
    replaceProp(static_cast<int>(i), prop);
  }
}

void World::Impl::setPartCount(std::size_t count) {
  while (parts.size() > count) {
    if (parts.back()->inWorld) world.removeRigidBody(parts.back()->body.get());
    parts.pop_back();
  }
  while (parts.size() < count) {
    auto part = std::make_unique<PartCollider>(kPartMargin);
    btRigidBody::btRigidBodyConstructionInfo construction(0.0f, nullptr, &part->shape);
    construction.m_friction = 1.0f;
    construction.m_restitution = 1.0f;
    part->body = std::make_unique<btRigidBody>(construction);
    part->body->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
    part->body->setActivationState(DISABLE_DEACTIVATION);
    part->body->setUserIndex(static_cast<int>(parts.size()));
    parts.push_back(std::move(part));
  }
}

void World::Impl::takePart(PartCollider& part, const LivePart& live, double seconds) {
  if (live.shape.degenerate()) {
    if (part.inWorld) world.removeRigidBody(part.body.get());
    part.inWorld = false;
    return;
  }
  part.sweep = sweepOf(live, seconds);
  part.body->setWorldTransform(part.sweep.at(0.0));

  part.reshaped = live.reshaped || !part.inWorld;
  if (part.reshaped) part.shape.setPoints(live.shape.vertices);
  if (!part.inWorld) {
    world.addRigidBody(part.body.get(), kPartGroup, kPropGroup);
    part.inWorld = true;
  }
}

/// Moves the contacts of changed hulls to the new surface, or removes them. Bullet tracks a contact by its positions on
/// both bodies, so a prop would rest forever on a surface that is no longer there. If all contacts of a changed hull
/// were removed instead, resting props would creep, because new contacts have no accumulated impulses.
void World::Impl::followSurfaces() {
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    btPersistentManifold* manifold = dispatcher.getManifoldByIndexInternal(m);
    const bool partIsA = manifold->getBody0()->isKinematicObject();
    const btCollisionObject* object = partIsA ? manifold->getBody0() : manifold->getBody1();
    if (!object->isKinematicObject()) continue;
    const PartCollider& part = *parts[object->getUserIndex()];
    if (!part.reshaped) continue;
    for (int i = manifold->getNumContacts() - 1; i >= 0; --i) {
      btManifoldPoint& contact = manifold->getContactPoint(i);
      const btVector3 outwards = partIsA ? -contact.m_normalWorldOnB : contact.m_normalWorldOnB;
      btVector3& position = partIsA ? contact.m_localPointA : contact.m_localPointB;
      if (!follow(part.shape, outwards * object->getWorldTransform().getBasis(), position)) {
        manifold->removeContactPoint(i);
      }
    }
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
  for (const std::unique_ptr<PartCollider>& part : parts) {
    const Sweep& sweep = part->sweep;
    const double turning = std::abs(sweep.angle) / seconds * sweep.radius;
    if (!part->inWorld || sweep.travel.norm() / seconds + turning + fastestProp <= rate) continue;
    const Vec3 position = sweep.origin + fraction * sweep.travel;
    for (const PropBody& prop : propBodies) {
      const Vec3 velocity = sweep.travel / seconds - fromBullet(prop.body->getLinearVelocity());
      const double speed = std::min(velocity.norm() + turning + prop.spin(), kFastestApproach);
      if (speed <= rate) continue;
      // Can the bounding spheres, on straight paths, meet within a usual substep?
      const Vec3 apart = position - fromBullet(prop.body->getWorldTransform().getOrigin());
      const double soonest = std::clamp(-apart.dot(velocity) / std::max(velocity.squaredNorm(), 1e-12), 0.0, usual);
      if ((apart + soonest * velocity).norm() <= sweep.radius + prop.radius + kLongestApproach) rate = speed;
    }
  }
  return kLongestApproach / rate;
}

void World::Impl::collectContacts() {
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    const btPersistentManifold* manifold = dispatcher.getManifoldByIndexInternal(m);
    const btCollisionObject* a = manifold->getBody0();
    const btCollisionObject* b = manifold->getBody1();
    if (a->isKinematicObject() == b->isKinematicObject()) continue;
    const bool partIsA = a->isKinematicObject();
    for (int i = 0; i < manifold->getNumContacts(); ++i) {
      const btManifoldPoint& point = manifold->getContactPoint(i);
      if (point.getDistance() > 0.0f && point.getAppliedImpulse() <= 0.0f) continue;
      Contact contact;
      contact.part = (partIsA ? a : b)->getUserIndex();
      contact.prop = (partIsA ? b : a)->getUserIndex();
      contact.point = fromBullet(partIsA ? point.getPositionWorldOnA() : point.getPositionWorldOnB());
      contact.normal = fromBullet(partIsA ? -point.m_normalWorldOnB : point.m_normalWorldOnB);
      contact.depth = -static_cast<double>(point.getDistance());
      contact.impulse = point.getAppliedImpulse();
      noteContact(contact);
    }
  }
}

// Parts are kinematic and may press a prop into the floor. Pressed in by more than half, it would fall through.
void World::Impl::keepAboveFloor() {
  if (!settings.floor) return;
  for (const PropBody& prop : propBodies) {
    btRigidBody& body = *prop.body;
    const btVector3 position = body.getWorldTransform().getOrigin();
    if (body.isStaticObject() || position.y() >= 0.0f) continue;
    btTransform lifted = body.getWorldTransform();
    lifted.setOrigin(btVector3(position.x(), 0.0f, position.z()));
    body.setWorldTransform(lifted);
    const btVector3 velocity = body.getLinearVelocity();
    body.setLinearVelocity(btVector3(velocity.x(), std::max(velocity.y(), 0.0f), velocity.z()));
  }
}

void World::Impl::noteContact(const Contact& contact) {
  for (Contact& known : contacts) {
    if (known.part != contact.part || known.prop != contact.prop) continue;
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

World::World() : World(Settings()) {}
World::World(const Settings& settings) : impl_(std::make_unique<Impl>(settings)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

int World::addProp(const Prop& prop) {
  impl_->addProp(prop);
  return static_cast<int>(impl_->props.size()) - 1;
}

void World::addLink(int a, int b, const Vec3& position) {
  impl_->addLink(a, b, position);
}

void World::setParticles(const ParticleSettings& settings) {
  particles_ = std::make_unique<Particles>(settings);
}

void World::step(std::span<const LivePart> parts, double seconds) {
  LORICA_CHECK(seconds >= 0.0 && std::isfinite(seconds), "the length of a step must be finite and at least zero");
  impl_->contacts.clear();
  impl_->resolveInitialOverlaps(parts);
  impl_->setPartCount(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) impl_->takePart(*impl_->parts[i], parts[i], seconds);

  impl_->followSurfaces();

  const double usual = seconds / std::max(1.0, std::ceil(seconds / impl_->settings.substepSeconds - 1e-6));
  double done = 0.0;  // of the frame
  while (seconds > 0.0 && done < 1.0) {
    // The rest of the frame is split into equal substeps.
    const double longest = impl_->longestSubstep(done, usual, seconds);
    const double left = std::max(1.0, std::ceil((1.0 - done) * seconds / longest - 1e-6));
    const double length = (1.0 - done) * seconds / left;
    // Like props, parts have their pose at the start of the substep and a velocity.
    for (const std::unique_ptr<PartCollider>& part : impl_->parts) {
      part->body->setWorldTransform(part->sweep.at(done));
      const double rate = part->sweep.strength / seconds;
      part->body->setLinearVelocity(toBullet(Vec3(rate * part->sweep.travel)));
      part->body->setAngularVelocity(toBullet(Vec3(rate * part->sweep.angle * part->sweep.axis)));
    }
    // A substep of maximum length corrects a fifth of each overlap and of each joint's position error; shorter substeps
    // correct less. Otherwise a chain stretched by an arm would snap back faster in shorter substeps.
    btContactSolverInfo& solving = impl_->world.getSolverInfo();
    solving.m_erp = solving.m_erp2 =
        static_cast<btScalar>(0.2 * std::min(1.0, length / impl_->settings.substepSeconds));
    impl_->drawGrabbed(length);
    impl_->world.stepSimulation(static_cast<btScalar>(length), 0);
    impl_->collectContacts();
    impl_->keepAboveFloor();
    done = left == 1.0 ? 1.0 : done + (1.0 - done) / left;
  }
  for (const std::unique_ptr<PartCollider>& part : impl_->parts) part->body->setWorldTransform(part->sweep.at(1.0));

  std::sort(impl_->contacts.begin(), impl_->contacts.end(), [](const Contact& a, const Contact& b) {
    return std::make_tuple(a.part, a.prop, a.point.x(), a.point.y(), a.point.z()) <
           std::make_tuple(b.part, b.prop, b.point.x(), b.point.y(), b.point.z());
  });
  impl_->readProps();
  particleSeconds_ = 0.0;
  if (particles_ && seconds > 0.0) {
    const auto begin = std::chrono::steady_clock::now();
    particles_->step(parts, seconds);
    particleSeconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
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
