#pragma once

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

namespace lorica {

/// Bullet's solver, with friction that holds. Internal.
///
/// Bullet lets friction work along one direction at each contact, that of sliding, and resists nothing across it: what
/// lies on something drifts by up to a millimetre a second, and stacks creep apart. On the floor they fall asleep
/// before it shows; on a live part nothing sleeps. There slow contacts get both directions, along fixed axes.
class ContactSolver : public btSequentialImpulseConstraintSolver {
 protected:
  void convertContacts(btPersistentManifold** manifolds, int count, const btContactSolverInfo& info) override;

 private:
  void markCarried(btPersistentManifold** manifolds, int count);

  int mark_ = 0;  ///< second user index of what is carried in this substep
};

/// Bullet's world, mended where things hit fast and where bodies are moved from outside. Internal.
class DynamicsWorld : public btDiscreteDynamicsWorld {
 public:
  using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;

  /// Contacts that will close within the substep count as closed where things bounce. Bullet would else take from the
  /// bounce the speed that closes them, so that it would depend on where in the substep things meet.
  void performDiscreteCollisionDetection() override;

 protected:
  /// Bullet would take the velocities of kinematic bodies from the difference of single-precision transforms over one
  /// substep, where a turn slower than 10 degrees a second drowns in rounding. Ours are set before each substep
  /// instead.
  void saveKinematicState(btScalar /*seconds*/) override {}
};

}  // namespace lorica
