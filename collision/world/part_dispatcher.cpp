#include "collision/world/part_dispatcher.h"

#include "collision/world/part_shape.h"

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <utility>

namespace lorica {
namespace {

const btCollisionObject* objectOf(const btBroadphaseProxy* proxy) {
  return static_cast<const btCollisionObject*>(proxy->m_clientObject);
}

bool isPart(const btCollisionObject* object) {
  return object->isKinematicObject();
}

/// Whether a box b, given in some frame, is separated from a box aligned with that frame along one of its axes.
bool apartAlongAxes(const btVector3& low, const btVector3& high, const btVector3& centerOfB, const btVector3& halfOfB) {
  const btVector3 lowOfB = centerOfB - halfOfB;
  const btVector3 highOfB = centerOfB + halfOfB;
  for (int axis = 0; axis < 3; ++axis) {
    if (lowOfB[axis] > high[axis] || highOfB[axis] < low[axis]) return true;
  }
  return false;
}

// Distances come from an iteration with a relative tolerance of 1e-4.
constexpr btScalar kUncertain = 1.001f;

/// Whether a part and a convex shape are farther apart than `gap` plus both margins. False if that is uncertain.
bool areApart(const btCollisionObject& part, const btConvexInternalShape& shape, const btTransform& worldFromShape,
              btScalar gap) {
  const auto& hull = static_cast<const PartShape&>(*part.getCollisionShape());
  gap += hull.getMargin() + shape.getMargin();

  // First test the boxes around both, each along its own axes.
  btVector3 low, high;
  shape.getAabb(btTransform::getIdentity(), low, high);
  const btVector3 half = btScalar(0.5) * (high - low);
  const btVector3 centerOfShape = btScalar(0.5) * (high + low);
  const btVector3 halfOfHull = btScalar(0.5) * (hull.high() - hull.low());
  const btVector3 centerOfHull = btScalar(0.5) * (hull.high() + hull.low());
  const btVector3 gaps(gap, gap, gap);
  const btTransform partFromShape = part.getWorldTransform().inverseTimes(worldFromShape);
  const btMatrix3x3 spread = partFromShape.getBasis().absolute();
  if (apartAlongAxes(hull.low(), hull.high(), partFromShape * centerOfShape, spread * half + gaps)) return true;
  if (apartAlongAxes(low, high, partFromShape.invXform(centerOfHull), spread.transpose() * halfOfHull + gaps)) {
    return true;
  }

  // Then all of both along the line between the boxes.
  const btVector3 across = partFromShape * centerOfShape - centerOfHull;
  if (!across.fuzzyZero()) {
    const btVector3 direction = across.normalized();
    const btVector3 nearest = shape.localGetSupportingVertexWithoutMargin(-direction * partFromShape.getBasis());
    const btVector3 farthest = hull.localGetSupportingVertexWithoutMargin(direction);
    if ((partFromShape * nearest - farthest).dot(direction) > kUncertain * gap) return true;
  }

  btGjkEpaSolver2::sResults results;
  const bool measured =
      btGjkEpaSolver2::Distance(&hull, part.getWorldTransform(), &shape, worldFromShape,
                                part.getWorldTransform() * centerOfHull - worldFromShape.getOrigin(), results);
  return measured && results.distance > kUncertain * gap;
}

/// Whether a part and a prop are certainly farther apart than `gap` plus their margins.
bool areApart(const btCollisionObject& part, const btCollisionObject& prop, btScalar gap) {
  const btCollisionShape* shape = prop.getCollisionShape();
  const btTransform& worldFromProp = prop.getWorldTransform();
  if (!shape->isCompound()) {
    return areApart(part, static_cast<const btConvexInternalShape&>(*shape), worldFromProp, gap);
  }
  const auto& compound = static_cast<const btCompoundShape&>(*shape);
  for (int i = 0; i < compound.getNumChildShapes(); ++i) {
    const auto& child = static_cast<const btConvexInternalShape&>(*compound.getChildShape(i));
    if (!areApart(part, child, worldFromProp * compound.getChildTransform(i), gap)) return false;
  }
  return true;
}

/// A pair that has contacts must be processed until Bullet drops them.
bool hasContacts(btCollisionAlgorithm& algorithm) {
  thread_local btManifoldArray manifolds;
  manifolds.resizeNoInitialize(0);
  algorithm.getAllContactManifolds(manifolds);
  for (int i = 0; i < manifolds.size(); ++i) {
    if (manifolds[i]->getNumContacts() > 0) return true;
  }
  return false;
}

}  // namespace

PartDispatcher::PartDispatcher(btCollisionConfiguration* configuration) : btCollisionDispatcher(configuration) {
  setNearCallback(nearCallback);
}

bool PartDispatcher::canTouch(const btBroadphasePair& pair, btScalar further) const {
  const btCollisionObject* a = objectOf(pair.m_pProxy0);
  const btCollisionObject* b = objectOf(pair.m_pProxy1);
  if (isPart(a) == isPart(b)) return true;
  if (pair.m_algorithm != nullptr && hasContacts(*pair.m_algorithm)) return true;
  if (!isPart(a)) std::swap(a, b);
  const btCollisionShape* shape = b->getCollisionShape();
  return !areApart(*a, *b, shape->getContactBreakingThreshold(gContactBreakingThreshold) + further);
}

void PartDispatcher::process(btBroadphasePair& pair, const btDispatcherInfo& info) {
  if (canTouch(pair, 0.0f)) defaultNearCallback(pair, *this, info);
}

void PartDispatcher::nearCallback(btBroadphasePair& pair, btCollisionDispatcher& dispatcher,
                                  const btDispatcherInfo& info) {
  static_cast<PartDispatcher&>(dispatcher).process(pair, info);
}

btCollisionAlgorithm* PartDispatcher::findAlgorithm(const btCollisionObjectWrapper* a,
                                                    const btCollisionObjectWrapper* b, btPersistentManifold* shared,
                                                    ebtDispatcherQueryType type) {
  const auto isBall = [](const btCollisionObjectWrapper* body) {
    return body->getCollisionShape()->getShapeType() == SPHERE_SHAPE_PROXYTYPE;
  };
  const auto isConvex = [](const btCollisionObjectWrapper* body) { return body->getCollisionShape()->isConvex(); };
  const bool upright = ballsUpright_ && isBall(a) != isBall(b) && isConvex(a) && isConvex(b);
  if (!upright || type != BT_CONTACT_POINT_ALGORITHMS) {
    return btCollisionDispatcher::findAlgorithm(a, b, shared, type);
  }
  btCollisionAlgorithmConstructionInfo construction;
  construction.m_dispatcher1 = this;
  construction.m_manifold = shared;
  return upright_.CreateCollisionAlgorithm(construction, a, b);
}

btPersistentManifold* PartDispatcher::getNewManifold(const btCollisionObject* a, const btCollisionObject* b) {
  const std::lock_guard lock(mutex_);
  return btCollisionDispatcher::getNewManifold(a, b);
}

void PartDispatcher::releaseManifold(btPersistentManifold* manifold) {
  const std::lock_guard lock(mutex_);
  btCollisionDispatcher::releaseManifold(manifold);
}

void* PartDispatcher::allocateCollisionAlgorithm(int size) {
  const std::lock_guard lock(mutex_);
  return btCollisionDispatcher::allocateCollisionAlgorithm(size);
}

void PartDispatcher::freeCollisionAlgorithm(void* algorithm) {
  const std::lock_guard lock(mutex_);
  btCollisionDispatcher::freeCollisionAlgorithm(algorithm);
}

void PartDispatcher::orderManifolds(btOverlappingPairCache& pairs) {
  m_manifoldsPtr.resizeNoInitialize(0);
  for (int p = 0; p < pairs.getNumOverlappingPairs(); ++p) {
    btCollisionAlgorithm* algorithm = pairs.getOverlappingPairArray()[p].m_algorithm;
    if (algorithm != nullptr) algorithm->getAllContactManifolds(m_manifoldsPtr);
  }
  for (int m = 0; m < m_manifoldsPtr.size(); ++m) m_manifoldsPtr[m]->m_index1a = m;
}

}  // namespace lorica
