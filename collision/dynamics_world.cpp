#include "collision/dynamics_world.h"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace lorica {
namespace {

constexpr btScalar kSlow = 0.05f;  // [m/s]

/// Velocity of the second body as the first one sees it, at a contact.
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

void ContactSolver::convertContacts(btPersistentManifold** manifolds, int count, const btContactSolverInfo& info) {
  btContactSolverInfo both = info;
  both.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
  for (int m = 0; m < count; ++m) convertContact(manifolds[m], isSlow(*manifolds[m]) ? both : info);
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
