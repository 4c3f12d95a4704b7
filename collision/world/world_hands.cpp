#include "collision/world/bullet_math.h"
#include "collision/world/world_impl.h"
#include "geometry/result.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

constexpr double kFarthestPick = 200.0;  // [m]
constexpr double kGrabReach = 1.0;       // max distance of the held point from the prop's bounding sphere [m]
// Limits of the joint: a prop of up to 60 kg can be lifted, and none is accelerated violently.
constexpr double kMaxForce = 600.0;         // [N]
constexpr double kMaxAcceleration = 200.0;  // [m/s^2]
constexpr double kDrawSpeed = 8.0;          // [m/s]
constexpr double kLongestLead = 0.15;       // max distance of the joint's target from the held point [m]
constexpr double kStiffness = 25.0;         // rate at which the distance is corrected [1/s]
constexpr btScalar kHeldDamping = 0.98f;    // share of the angular velocity lost per second

/// The first prop or the floor along a ray; parts are ignored.
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
  pick.distance = kFarthestPick * nearest.m_closestHitFraction;
  pick.position = ray.origin + pick.distance / length * ray.direction;
  return pick;
}

bool World::grab(int prop, const Vec3& position) {
  release();
  if (!impl_->isProp(prop) || !position.allFinite()) return false;
  const PropBody& held = impl_->propBodies[prop];
  btRigidBody& body = *held.body;
  if (body.isStaticObject()) return false;
  const btTransform& worldFromBody = body.getWorldTransform();
  if ((position - fromBullet(worldFromBody.getOrigin())).norm() > held.radius + kGrabReach) return false;
  GrabAnchor grab;
  grab.prop = prop;
  grab.target = position;
  grab.drawn = position;
  grab.inBody = worldFromBody.inverse() * toBullet(position);
  grab.joint = std::make_unique<btPoint2PointConstraint>(body, grab.inBody);
  impl_->world.addConstraint(grab.joint.get(), false);
  body.setActivationState(DISABLE_DEACTIVATION);
  body.setDamping(0.0f, kHeldDamping);
  impl_->grabbed = std::move(grab);
  return true;
}

void World::moveGrab(const Vec3& position) {
  if (impl_->grabbed && position.allFinite()) impl_->grabbed->target = position;
}

void World::release(const Vec3& velocity) {
  if (impl_->grabbed && !velocity.isZero(0.0) && velocity.allFinite()) {
    impl_->propBodies[impl_->grabbed->prop].body->setLinearVelocity(toBullet(velocity));
  }
  impl_->release();
}

void World::Impl::release() {
  if (!grabbed) return;
  btRigidBody& body = *propBodies[grabbed->prop].body;
  world.removeConstraint(grabbed->joint.get());
  body.setDamping(0.0f, 0.0f);
  body.forceActivationState(ACTIVE_TAG);
  body.setDeactivationTime(0.0f);
  grabbed.reset();
}

std::optional<PropGrab> World::held() const {
  if (!impl_->grabbed) return std::nullopt;
  const GrabAnchor& grab = *impl_->grabbed;
  const btRigidBody& body = *impl_->propBodies[grab.prop].body;
  return PropGrab{grab.prop, fromBullet(body.getWorldTransform() * grab.inBody), grab.target};
}

/// Sets the joint for a substep. Its force is limited, and it pulls to a nearby position that moves on to the target.
/// So the prop stays slow enough not to pass through anything, however distant the target is.
void World::Impl::drawGrabbed(double seconds) {
  if (!grabbed) return;
  const PropBody& held = propBodies[grabbed->prop];
  const Vec3 toTarget = grabbed->target - grabbed->drawn;
  grabbed->drawn += toTarget * std::min(1.0, kDrawSpeed * seconds / std::max(toTarget.norm(), 1e-9));
  const Vec3 position = fromBullet(held.body->getWorldTransform() * grabbed->inBody);
  const Vec3 lead = grabbed->drawn - position;
  grabbed->drawn = position + lead * std::min(1.0, kLongestLead / std::max(lead.norm(), 1e-9));
  grabbed->joint->setPivotB(toBullet(grabbed->drawn));
  const double mass = 1.0 / held.body->getInvMass();
  const double force = std::min(kMaxForce, kMaxAcceleration * mass);
  grabbed->joint->m_setting.m_impulseClamp = force * seconds;
  grabbed->joint->setParam(BT_CONSTRAINT_ERP, std::min(0.5, kStiffness * seconds), -1);
}

int World::throwProp(const Prop& prop) {
  LORICA_CHECK(prop.mass > 0.0, "a static body cannot be thrown");
  std::deque<int>& thrown = impl_->thrown;
  if (thrown.size() < kMaxThrown) {
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
  PropBody& old = propBodies[index];
  world.removeRigidBody(old.body.get());
  // Bodies that rested on it may be asleep.
  for (const PropBody& body : propBodies) {
    if (!body.body->isStaticObject()) body.body->activate();
  }
  old = makePropBody(prop, index);
  addBody(old, prop.mass == 0.0);
  props[index] = prop;
}

}  // namespace lorica
