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
  ++mark_;
  const auto carries = [&](const btCollisionObject* object) {
    return object->isKinematicObject() || (!object->isStaticObject() && object->getUserIndex2() == mark_);
  };
  for (bool more = true; more;) {
    more = false;
    for (int m = 0; m < count; ++m) {
      const btPersistentManifold& manifold = *manifolds[m];
      if (manifold.getNumContacts() == 0 || carries(manifold.getBody0()) == carries(manifold.getBody1())) continue;
      const btCollisionObject* carried = carries(manifold.getBody0()) ? manifold.getBody1() : manifold.getBody0();
      if (carried->isStaticObject()) continue;
      const_cast<btCollisionObject*>(carried)->setUserIndex2(mark_);  // as Bullet's own solver does with its indices
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
    const bool carried = manifold.getBody0()->getUserIndex2() == mark_ || manifold.getBody1()->getUserIndex2() == mark_;
    convertContact(manifolds[m], carried && isSlow(manifold) ? both : info);
  }
}

void DynamicsWorld::performDiscreteCollisionDetection() {
  btDiscreteDynamicsWorld::performDiscreteCollisionDetection();
  const btScalar seconds = getDispatchInfo().m_timeStep;
  for (int m = 0; m < getDispatcher()->getNumManifolds(); ++m) {
    btPersistentManifold* manifold = getDispatcher()->getManifoldByIndexInternal(m);
    for (int i = 0; i < manifold->getNumContacts(); ++i) {
      btManifoldPoint& contact = manifold->getContactPoint(i);
      if (contact.getDistance() <= 0.0f || contact.m_combinedRestitution <= 0.0f) continue;
      const btScalar closing = velocityBetween(*manifold, contact).dot(contact.m_normalWorldOnB);
      if (closing > getSolverInfo().m_restitutionVelocityThreshold && closing * seconds > contact.getDistance()) {
        contact.setDistance(0.0f);
      }
    }
  }
}

}  // namespace lorica
