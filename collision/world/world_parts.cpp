#include "collision/live/extent_kernel.h"
#include "collision/world/bullet_math.h"
#include "collision/world/strike_limit.h"
#include "collision/world/world_impl.h"
#include "geometry/counts.h"
#include "geometry/threads.h"

#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

// Hulls are inflated by this so that GJK sees touching shapes as separate. Boxes and balls have their margin inside.
constexpr btScalar kPartMargin = 0.001f;
// Maximum distance over which a contact follows the hull's surface from frame to frame, and the height above the
// surface from which the new position is searched.
constexpr btScalar kFollowed = 0.002f;
constexpr btScalar kLookFrom = 0.004f;
constexpr btScalar kSameNormal = 0.99f;  // cosine
// With more parts in all, those that are farther than this from every prop are left out [m]. To leave, they must be
// farther still: coming and going costs more than staying.
constexpr std::size_t kCrowd = 128;
constexpr double kAhead = 0.25;
constexpr double kStay = 0.15;

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

  sweep.radius = part.radius;
  const double path = sweep.path();
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

/// Whether a part may meet one of the props in this frame.
/// @param further  additional distance [m]
bool mayMeet(const LivePart& part, std::span<const PropReach> props, double further) {
  const Vec3 begin = part.previousWorldFromPart.translation();
  const Vec3 travel = part.worldFromPart.translation() - begin;
  const Vec3 center = begin + 0.5 * travel;
  const double radius = part.radius + 0.5 * travel.norm() + further;
  return std::any_of(props.begin(), props.end(), [&](const PropReach& prop) {
    const double both = radius + prop.radius;
    return (prop.center - center).squaredNorm() <= both * both;
  });
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

void World::Impl::setPartCounts(std::span<const std::span<const LivePart>> present) {
  if (avatars.size() < present.size()) avatars.resize(present.size());
  std::size_t room = kMaxParts;
  for (std::size_t avatar = 0; avatar < avatars.size(); ++avatar) {
    const std::size_t count = avatar < present.size() ? std::min(present[avatar].size(), room) : 0;
    setPartCount(avatar, count);
    room -= count;
  }
}

void World::Impl::setPartCount(std::size_t avatar, std::size_t count) {
  std::vector<std::unique_ptr<PartCollider>>& parts = avatars[avatar];
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
    part->body->setUserIndex(countOf(parts));
    part->body->setUserIndex3(avatar);
    parts.push_back(std::move(part));
  }
}

/// Decides whether parts far from all props are left out: the broad phase costs most of the time of a crowd.
void World::Impl::findReaches(double seconds) {
  std::size_t count = 0;
  for (const auto& parts : avatars) count += parts.size();
  crowd.present = count > kCrowd;
  dispatcher.setBallsUpright(crowd.present);
  reaches.clear();
  widestReach = 0.0;
  if (!crowd.present) return;
  for (const PropBody& prop : propBodies) {
    if (prop.body->isStaticObject()) continue;
    PropReach reach;
    reach.center = fromBullet(prop.body->getWorldTransform().getOrigin());
    reach.radius = prop.radius + prop.speed() * seconds + kAhead;
    reach.begin = reach.center.x() - reach.radius;
    widestReach = std::max(widestReach, reach.radius);
    reaches.push_back(reach);
  }
  std::sort(reaches.begin(), reaches.end());
}

/// Lists the props that parts of an avatar may meet in this frame.
void World::Impl::findNear(std::span<const LivePart> parts, std::vector<PropReach>& near) const {
  near.clear();
  if (!crowd.present) return;
  Aabb bounds;
  for (const LivePart& part : parts) {
    if (part.shape.degenerate()) continue;
    const Vec3 around = Vec3::Constant(part.radius + kStay);
    for (const Isometry3& motion : {part.previousWorldFromPart, part.worldFromPart}) {
      bounds.extend(motion.translation() - around);
      bounds.extend(motion.translation() + around);
    }
  }
  PropReach first;
  first.begin = bounds.min.x() - 2.0 * widestReach;
  for (auto reach = std::lower_bound(reaches.begin(), reaches.end(), first);
       reach != reaches.end() && reach->begin <= bounds.max.x(); ++reach) {
    const Vec3 nearest = reach->center.cwiseMax(bounds.min).cwiseMin(bounds.max);
    if ((reach->center - nearest).squaredNorm() <= reach->radius * reach->radius) near.push_back(*reach);
  }
}

void World::Impl::takeParts(std::span<const std::span<const LivePart>> present, double seconds) {
  parallelFor(present.size(), [&](std::size_t a) {
    thread_local std::vector<PropReach> near;
    findNear(present[a].first(avatars[a].size()), near);
    for (std::size_t i = 0; i < avatars[a].size(); ++i) {
      if (i + 1 < avatars[a].size() && avatars[a][i + 1]->inWorld) fetch(present[a][i + 1].shape.vertices);
      readPart(*avatars[a][i], present[a][i], near, seconds);
    }
  });
  for (const auto& parts : avatars) {
    for (const std::unique_ptr<PartCollider>& part : parts) {
      if (part->inWorld == part->counts) continue;
      part->inWorld = part->counts;
      if (part->counts) {
        world.addRigidBody(part->body.get(), kPartGroup, kPropGroup);
      } else {
        world.removeRigidBody(part->body.get());
      }
    }
  }
}

/// @param near  props that the part may meet
void World::Impl::readPart(PartCollider& part, const LivePart& live, std::span<const PropReach> near,
                           double seconds) const {
  part.counts = !live.shape.degenerate() && (!crowd.present || mayMeet(live, near, part.inWorld ? kStay : 0.0));
  if (!part.counts) return;
  part.sweep = sweepOf(live, seconds);
  part.body->setWorldTransform(part.sweep.at(0.0));
  part.reshaped = live.reshaped || !part.inWorld;
  if (part.reshaped) part.shape.setPoints(live.shape.vertices);
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
    const PartCollider& part = *avatars[object->getUserIndex3()][object->getUserIndex()];
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

/// Like props, parts have their pose at the start of the substep and a velocity.
/// @param fraction  of the frame that is done
void World::Impl::movePart(PartCollider& part, double fraction, double seconds) {
  part.body->setWorldTransform(part.sweep.at(fraction));
  const double rate = part.sweep.strength / seconds;
  part.body->setLinearVelocity(toBullet(Vec3(rate * part.sweep.travel)));
  part.body->setAngularVelocity(toBullet(Vec3(rate * part.sweep.angle * part.sweep.axis)));
}

}  // namespace lorica
