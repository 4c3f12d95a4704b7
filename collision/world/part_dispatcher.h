#pragma once

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

namespace lorica {

/// Bullet's narrow phase, except that pairs of a part and a prop are skipped if they are certainly apart. Internal.
///
/// For two shapes whose bounds overlap, Bullet measures the distance eight times: twice in each of four orientations,
/// tilted slightly to find several contacts at once. Most pairs are centimetres apart; a test of oriented boxes or one
/// distance measurement rejects them.
class PartDispatcher : public btCollisionDispatcher {
 public:
  explicit PartDispatcher(btCollisionConfiguration* configuration);

 private:
  static void nearCallback(btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info);
  bool canTouch(const btBroadphasePair& pair);

  btManifoldArray manifolds_;  ///< scratch
};

}  // namespace lorica
