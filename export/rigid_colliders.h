#pragma once

#include "acd/decomposition.h"
#include "acd/hull_budget.h"
#include "collision/live/choose_cover.h"
#include "collision/live/lifted_point.h"
#include "export/capsule.h"
#include "geometry/convex_hull.h"
#include "skinning/character.h"

#include <functional>
#include <span>
#include <vector>

namespace lorica {

/// A convex collider that moves with one bone. Shapes are in model space as in the bind pose: in a pose a point p of
/// them is at worldFromModel[joint] * p.
struct RigidCollider {
  JointIndex joint = 0;  ///< that carries the hull
  PartIndex part = -1;   ///< of the decomposition; -1: of all parts, see perBone
  TriMesh hull;          ///< convex, counter-clockwise from outside [m]
  double volume = 0.0;   ///< of the hull [m^3]
  Capsule capsule;       ///< holds the same surface, for comparison
};

/// For each point the first one that moves as it does in every pose: files split vertices for normals and textures, up
/// to six times.
[[nodiscard]] std::vector<PointIndex> firstAlike(std::span<const LiftedPoint> lifted);

/// How rigid hulls are fitted to the bones.
struct RigidColliderSettings {
  HullBudget budget;     ///< of each hull
  bool perBone = false;  ///< one hull for each bone: the skin is cut along weights, and the parts are not used
  int threads = 0;       ///< 0 = all of the machine's; the result does not depend on it
  std::function<bool(int done, int hulls)> progress = {};  ///< false = stop
};

/// Colliders for engines whose colliders are rigid on one bone, where a live hull bends.
///
/// Every triangle of the surface belongs to the bone that moves it most. For each part and each of its bones, the
/// triangles of all poses are carried back to the bind pose by that bone; the collider is their convex hull. So in each
/// of these poses the colliders hold the whole surface of the body and every other vertex. Bones that move less than a
/// tenth of a part (with perBone: less than 1/1000 of the body) have no collider there: their triangles belong to the
/// nearest bone above them that has one, else to the part's strongest bone.
/// @param decomposition  made from the character's mesh
/// @param poses          at least one, see coverPoses()
/// @return by part, then by joint; or an error if a pose cannot be undone because a bone is scaled to nothing, or that
/// it
///         was stopped
[[nodiscard]] Result<std::vector<RigidCollider>> makeRigidColliders(const Character& character,
                                                                    const Decomposition& decomposition,
                                                                    BonePoseView poses,
                                                                    const RigidColliderSettings& settings);

}  // namespace lorica
