#pragma once

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

namespace lorica {

/// Bullet's narrow phase, except that pairs of a part and a prop are passed over where they are surely apart. Internal.
///
/// For two shapes whose bounds overlap Bullet measures the distance eight times: twice in each of four attitudes,
/// tilted a little to find several contacts at once. Most pairs are centimetres apart, and then boxes or one
/// measurement tell.
class PartDispatcher : public btCollisionDispatcher {
 public:
  explicit PartDispatcher(btCollisionConfiguration* configuration);

 private:
  static void nearCallback(btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info);
  bool canTouch(const btBroadphasePair& pair);

  btManifoldArray manifolds_;  ///< scratch
};

}  // namespace lorica
