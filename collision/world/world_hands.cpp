#include "collision/world/bullet_math.h"
#include "collision/world/world_impl.h"
#include "geometry/result.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

constexpr double kFarthestPick = 200.0;  // [m]
constexpr double kGrabReach = 1.0;       // a place that is held is no farther from its prop's sphere [m]
// The joint's pull: a prop of up to 60 kg can be lifted, and none is hurled.
constexpr double kMostForce = 600.0;         // [N]
constexpr double kMostAcceleration = 200.0;  // [m/s^2]
constexpr double kDrawSpeed = 8.0;           // [m/s]
constexpr double kLongestLead = 0.15;        // the joint draws to a place no farther from the prop's than that [m]
constexpr double kStiffness = 25.0;          // of the distance, so much is made good in a second [1/s]
constexpr btScalar kHeldDamping = 0.98f;     // of the spin, lost in a second

/// The first prop or floor along a ray; parts are no more than air.
struct NearestSolid : btCollisionWorld::ClosestRayResultCallback {
  using ClosestRayResultCallback::ClosestRayResultCallback;
  bool needsCollision(btBroadphaseProxy* proxy) const override {
    return (proxy->m_collisionFilterGroup & kPartGroup) == 0;
  }
};

}  // namespace

std::optional<PropPick> World::pick(const Ray& ray) const {
  const double length = ray.direction.norm();
  if (!(length > 0.0) || !std::isfinite(length) || !ray.origin.allFinite()) return std::nullopt;
  const Vec3 end = ray.origin + kFarthestPick / length * ray.direction;
  NearestSolid nearest(toBullet(ray.origin), toBullet(end));
  impl_->world.rayTest(nearest.m_rayFromWorld, nearest.m_rayToWorld, nearest);
  if (!nearest.hasHit() || nearest.m_collisionObject == impl_->floor.get()) return std::nullopt;
  PropPick pick;
  pick.prop = nearest.m_collisionObject->getUserIndex();
  pick.distance = kFarthestPick * static_cast<double>(nearest.m_closestHitFraction);
  pick.place = ray.origin + pick.distance / length * ray.direction;
  return pick;
}

bool World::grab(int prop, const Vec3& place) {
  release();
  if (!impl_->isProp(prop) || !place.allFinite()) return false;
  const PropBody& held = impl_->propBodies[static_cast<std::size_t>(prop)];
  btRigidBody& body = *held.body;
  if (body.isStaticObject()) return false;
  const btTransform& worldFromBody = body.getWorldTransform();
  if ((place - fromBullet(worldFromBody.getOrigin())).norm() > held.radius + kGrabReach) return false;
  GrabBody grab;
  grab.prop = prop;
  grab.target = place;
  grab.drawn = place;
  grab.inBody = worldFromBody.inverse() * toBullet(place);
  grab.joint = std::make_unique<btPoint2PointConstraint>(body, grab.inBody);
  impl_->world.addConstraint(grab.joint.get(), false);
  body.setActivationState(DISABLE_DEACTIVATION);
  body.setDamping(0.0f, kHeldDamping);
  impl_->grabbed = std::move(grab);
  return true;
}

void World::moveGrab(const Vec3& place) {
  if (impl_->grabbed && place.allFinite()) impl_->grabbed->target = place;
}

void World::release() {
  impl_->release();
}

void World::Impl::release() {
  if (!grabbed) return;
  btRigidBody& body = *propBodies[static_cast<std::size_t>(grabbed->prop)].body;
  world.removeConstraint(grabbed->joint.get());
  body.setDamping(0.0f, 0.0f);
  body.forceActivationState(ACTIVE_TAG);
  body.setDeactivationTime(0.0f);
  grabbed.reset();
}

std::optional<PropGrab> World::held() const {
  if (!impl_->grabbed) return std::nullopt;
  const GrabBody& grab = *impl_->grabbed;
  const btRigidBody& body = *impl_->propBodies[static_cast<std::size_t>(grab.prop)].body;
  return PropGrab{grab.prop, fromBullet(body.getWorldTransform() * grab.inBody), grab.target};
}

/// Sets the joint for a substep. Its force is bounded, and it draws to a place near the prop's own that moves on to the
/// target: the prop stays slow enough that nothing is passed through, however far away the target is.
void World::Impl::drawGrabbed(double seconds) {
  if (!grabbed) return;
  const PropBody& held = propBodies[static_cast<std::size_t>(grabbed->prop)];
  const Vec3 toTarget = grabbed->target - grabbed->drawn;
  grabbed->drawn += toTarget * std::min(1.0, kDrawSpeed * seconds / std::max(toTarget.norm(), 1e-9));
  const Vec3 place = fromBullet(held.body->getWorldTransform() * grabbed->inBody);
  const Vec3 lead = grabbed->drawn - place;
  grabbed->drawn = place + lead * std::min(1.0, kLongestLead / std::max(lead.norm(), 1e-9));
  grabbed->joint->setPivotB(toBullet(grabbed->drawn));
  const double mass = 1.0 / static_cast<double>(held.body->getInvMass());
  const double force = std::min(kMostForce, kMostAcceleration * mass);
  grabbed->joint->m_setting.m_impulseClamp = static_cast<btScalar>(force * seconds);
  grabbed->joint->setParam(BT_CONSTRAINT_ERP, static_cast<btScalar>(std::min(0.5, kStiffness * seconds)), -1);
}

int World::throwProp(const Prop& prop) {
  CHECK(prop.mass > 0.0, "furniture cannot be thrown");
  std::deque<int>& thrown = impl_->thrown;
  if (thrown.size() < kMostThrown) {
    thrown.push_back(addProp(prop));
  } else {
    thrown.push_back(thrown.front());
    thrown.pop_front();
    impl_->replaceProp(thrown.back(), prop);
  }
  return thrown.back();
}

void World::Impl::replaceProp(int index, const Prop& prop) {
  if (grabbed && grabbed->prop == index) release();
  PropBody& old = propBodies[static_cast<std::size_t>(index)];
  world.removeRigidBody(old.body.get());
  // What leaned on it may sleep.
  for (const PropBody& body : propBodies) {
    if (!body.body->isStaticObject()) body.body->activate();
  }
  old = makePropBody(prop, index);
  addBody(old, prop.mass == 0.0);
  props[static_cast<std::size_t>(index)] = prop;
}

}  // namespace lorica
