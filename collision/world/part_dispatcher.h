#pragma once

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>

#include <mutex>

namespace lorica {

/// Bullet's narrow phase, except that pairs of a part and a prop are skipped if they are certainly apart. Internal.
///
/// For two shapes whose bounds overlap, Bullet measures the distance eight times: twice in each of four orientations,
/// tilted slightly to find several contacts at once. Most pairs are centimetres apart; a test of oriented boxes or one
/// distance measurement rejects them.
class PartDispatcher : public btCollisionDispatcher {
 public:
  explicit PartDispatcher(btCollisionConfiguration* configuration);

  /// Whether new pairs of a ball and another convex shape are not tilted: they touch at one point.
  void setBallsUpright(bool upright) { ballsUpright_ = upright; }
  /// False for a part and a prop that are certainly apart by more than contacts reach.
  /// @param further  additional distance [m]
  [[nodiscard]] bool canTouch(const btBroadphasePair& pair, btScalar further) const;
  /// The narrow phase of a pair. Threads may process different pairs at the same time.
  void process(btBroadphasePair& pair, const btDispatcherInfo& info);
  /// Puts manifolds in the order of pairs, whatever threads created them.
  void orderManifolds(btOverlappingPairCache& pairs);

  btCollisionAlgorithm* findAlgorithm(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                                      btPersistentManifold* shared, ebtDispatcherQueryType type) override;
  btPersistentManifold* getNewManifold(const btCollisionObject* a, const btCollisionObject* b) override;
  void releaseManifold(btPersistentManifold* manifold) override;
  void* allocateCollisionAlgorithm(int size) override;
  void freeCollisionAlgorithm(void* algorithm) override;

 private:
  static void nearCallback(btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info);

  std::mutex mutex_;
  bool ballsUpright_ = false;
  btGjkEpaPenetrationDepthSolver depthSolver_;
  btConvexConvexAlgorithm::CreateFunc upright_{&depthSolver_};
};

}  // namespace lorica
