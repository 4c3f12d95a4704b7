#pragma once

#include "collision/world/dynamics_world.h"
#include "collision/world/world.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>

#include <memory>
#include <vector>

namespace lorica {

struct PartCollider;

/// Props that may touch within a tick, directly or through parts, with all that may touch them. Internal.
///
/// No other island reads or writes what one changes, so cores solve islands at the same time, each with the number of
/// substeps that its own fastest approach needs.
struct Island {
  std::vector<btCollisionObject*> props;
  std::vector<PartCollider*> parts;
  std::vector<btBroadphasePair*> pairs;
  std::vector<btTypedConstraint*> joints;
  std::vector<Contact> contacts;  ///< of all substeps
  btManifoldArray manifolds;      ///< with contacts, in this substep
  std::unique_ptr<ContactSolver> solver = std::make_unique<ContactSolver>();

  void clear();
};

/// Sets of numbers that are united step by step; the name of a set is its smallest number. Internal.
class DisjointSets {
 public:
  void reset(int count);
  [[nodiscard]] int find(int i);
  void unite(int i, int j);

 private:
  std::vector<int> parents_;
};

/// A part of a frame in which bodies keep their islands. Internal.
struct Tick {
  double begin = 0.0;    ///< fraction of the frame
  double share = 0.0;    ///< length as a fraction of the frame
  double seconds = 0.0;  ///< length of the frame
};

/// What a world needs to step a crowd; memory is kept from tick to tick. Internal.
struct Crowd {
  bool present = false;  ///< many parts: those far from all props are left out, and islands step on their own
  std::vector<PartCollider*> parts;  ///< those in the world
  DisjointSets sets;                 ///< of props, then parts
  std::vector<int> islandOfSet;      ///< index in `islands`, or -1
  std::vector<Island> islands;
  std::size_t islandCount = 0;      ///< of `islands`, in this tick
  std::vector<std::size_t> bySize;  ///< the islands, the largest first
  btManifoldArray manifolds;        ///< scratch
};

}  // namespace lorica
