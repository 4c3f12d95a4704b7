#include "collision/world/dynamics_world.h"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace lorica {
namespace {

constexpr btScalar kSlow = 0.05f;  // [m/s]

/// Velocity of the second body relative to the first at a contact.
btVector3 velocityBetween(const btPersistentManifold& manifold, const btManifoldPoint& contact) {
  const auto& a = static_cast<const btRigidBody&>(*manifold.getBody0());
  const auto& b = static_cast<const btRigidBody&>(*manifold.getBody1());
  return b.getVelocityInLocalPoint(contact.getPositionWorldOnB() - b.getCenterOfMassPosition()) -
         a.getVelocityInLocalPoint(contact.getPositionWorldOnA() - a.getCenterOfMassPosition());
}

bool isSlow(const btPersistentManifold& manifold) {
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    if (velocityBetween(manifold, manifold.getContactPoint(i)).length2() > kSlow * kSlow) return false;
  }
  return true;
}

}  // namespace

/// Marks all bodies that rest on a kinematic body, directly or through other bodies.
void ContactSolver::markCarried(btPersistentManifold** manifolds, int count) {
  carried_.resizeNoInitialize(0);
  const auto carries = [&](const btCollisionObject* object) {
    return object->isKinematicObject() || (!object->isStaticObject() && object->getUserIndex2() == 1);
  };
  for (bool more = true; more;) {
    more = false;
    for (int m = 0; m < count; ++m) {
      const btPersistentManifold& manifold = *manifolds[m];
      if (manifold.getNumContacts() == 0 || carries(manifold.getBody0()) == carries(manifold.getBody1())) continue;
      const btCollisionObject* found = carries(manifold.getBody0()) ? manifold.getBody1() : manifold.getBody0();
      if (found->isStaticObject()) continue;
      auto* carried = const_cast<btCollisionObject*>(found);  // as Bullet's own solver does for its indices
      carried->setUserIndex2(1);
      carried_.push_back(carried);
      more = true;
    }
  }
}

void ContactSolver::convertContacts(btPersistentManifold** manifolds, int count, const btContactSolverInfo& info) {
  markCarried(manifolds, count);
  btContactSolverInfo both = info;
  both.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
  for (int m = 0; m < count; ++m) {
    const btPersistentManifold& manifold = *manifolds[m];
    const bool carried = manifold.getBody0()->getUserIndex2() == 1 || manifold.getBody1()->getUserIndex2() == 1;
    convertContact(manifolds[m], carried && isSlow(manifold) ? both : info);
  }
  for (int i = 0; i < carried_.size(); ++i) carried_[i]->setUserIndex2(0);
}

void closeFastContacts(btPersistentManifold& manifold, btScalar threshold, btScalar seconds) {
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    btManifoldPoint& contact = manifold.getContactPoint(i);
    if (contact.getDistance() <= 0.0f || contact.m_combinedRestitution <= 0.0f) continue;
    const btScalar closing = velocityBetween(manifold, contact).dot(contact.m_normalWorldOnB);
    if (closing > threshold && closing * seconds > contact.getDistance()) contact.setDistance(0.0f);
  }
}

void DynamicsWorld::performDiscreteCollisionDetection() {
  btDiscreteDynamicsWorld::performDiscreteCollisionDetection();
  for (int m = 0; m < getDispatcher()->getNumManifolds(); ++m) {
    closeFastContacts(*getDispatcher()->getManifoldByIndexInternal(m), getSolverInfo().m_restitutionVelocityThreshold,
                      getDispatchInfo().m_timeStep);
  }
}

}  // namespace lorica
