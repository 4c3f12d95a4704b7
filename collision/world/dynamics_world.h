#pragma once

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

namespace lorica {

/// Bullet's solver with friction that keeps resting bodies in position. Internal.
///
/// Bullet applies friction along one direction per contact, the direction of sliding, and none across it. Resting
/// bodies therefore drift by up to a millimetre per second, and stacks creep apart. On the floor bodies fall asleep
/// before this shows; on a live part nothing sleeps. There, slow contacts get two friction directions along fixed axes.
class ContactSolver : public btSequentialImpulseConstraintSolver {
 protected:
  void convertContacts(btPersistentManifold** manifolds, int count, const btContactSolverInfo& info) override;

 private:
  void markCarried(btPersistentManifold** manifolds, int count);

  btAlignedObjectArray<btCollisionObject*> carried_;  ///< their second user index is 1
};

/// Contacts with restitution that will close within the substep count as closed. Otherwise Bullet would subtract the
/// speed that closes the gap from the bounce, so the bounce would depend on when in the substep the bodies meet.
/// Internal.
/// @param threshold  slower contacts do not bounce [m/s]
void closeFastContacts(btPersistentManifold& manifold, btScalar threshold, btScalar seconds);

/// Bullet's world with corrections for fast impacts and for kinematic bodies. Internal.
class DynamicsWorld : public btDiscreteDynamicsWorld {
 public:
  using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;

  /// With closeFastContacts().
  void performDiscreteCollisionDetection() override;

 protected:
  /// Does nothing. Bullet would compute the velocities of kinematic bodies from the difference of single-precision
  /// transforms over one substep, where a rotation slower than 10 degrees per second is lost in rounding. World sets
  /// these velocities before each substep instead.
  void saveKinematicState(btScalar /*seconds*/) override {}
};

}  // namespace lorica
