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

bool isHand(int hand) {
  return hand >= 0 && hand < World::kMaxHands;
}

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

bool World::grab(int prop, const Vec3& position, int hand) {
  if (!isHand(hand)) return false;
  impl_->release(hand);
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
  impl_->grabs[hand] = std::move(grab);
  return true;
}

void World::moveGrab(const Vec3& position, int hand) {
  if (isHand(hand) && impl_->grabs[hand] && position.allFinite()) impl_->grabs[hand]->target = position;
}

void World::release(const Vec3& velocity, int hand) {
  if (!isHand(hand) || !impl_->grabs[hand]) return;
  const int prop = impl_->grabs[hand]->prop;
  impl_->release(hand);
  const bool thrown = impl_->holdersOf(prop) == 0 && !velocity.isZero(0.0) && velocity.allFinite();
  if (thrown) impl_->propBodies[prop].body->setLinearVelocity(toBullet(velocity));
}

int World::Impl::holdersOf(int prop) const {
  return static_cast<int>(
      std::ranges::count_if(grabs, [prop](const auto& grab) { return grab && grab->prop == prop; }));
}

void World::Impl::release(int hand) {
  if (!grabs[hand]) return;
  const int prop = grabs[hand]->prop;
  world.removeConstraint(grabs[hand]->joint.get());
  grabs[hand].reset();
  if (holdersOf(prop) > 0) return;
  btRigidBody& body = *propBodies[prop].body;
  body.setDamping(0.0f, 0.0f);
  body.forceActivationState(ACTIVE_TAG);
  body.setDeactivationTime(0.0f);
}

std::optional<PropGrab> World::held(int hand) const {
  if (!isHand(hand) || !impl_->grabs[hand]) return std::nullopt;
  const GrabAnchor& grab = *impl_->grabs[hand];
  const btRigidBody& body = *impl_->propBodies[grab.prop].body;
  return PropGrab{grab.prop, fromBullet(body.getWorldTransform() * grab.inBody), grab.target};
}

/// Sets the joint of a hand for a substep. Its force is limited, and it pulls to a nearby position that moves on to the
/// target. So the prop stays slow enough not to pass through anything, however distant the target is.
void World::Impl::drawGrabbed(int hand, double seconds) {
  if (!grabs[hand]) return;
  GrabAnchor& grab = *grabs[hand];
  const PropBody& held = propBodies[grab.prop];
  const Vec3 toTarget = grab.target - grab.drawn;
  grab.drawn += toTarget * std::min(1.0, kDrawSpeed * seconds / std::max(toTarget.norm(), 1e-9));
  const Vec3 position = fromBullet(held.body->getWorldTransform() * grab.inBody);
  const Vec3 lead = grab.drawn - position;
  grab.drawn = position + lead * std::min(1.0, kLongestLead / std::max(lead.norm(), 1e-9));
  grab.joint->setPivotB(toBullet(grab.drawn));
  const double mass = 1.0 / held.body->getInvMass();
  const double force = std::min(kMaxForce, kMaxAcceleration * mass / holdersOf(grab.prop));
  grab.joint->m_setting.m_impulseClamp = force * seconds;
  grab.joint->setParam(BT_CONSTRAINT_ERP, std::min(0.5, kStiffness * seconds), -1);
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
  for (int hand = 0; hand < kMaxHands; ++hand) {
    if (grabs[hand] && grabs[hand]->prop == index) release(hand);
  }
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
