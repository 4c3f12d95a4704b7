#pragma once

#include "geometry/result.h"
#include "skinning/character.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

struct BodySettings {
  double resolution = 0.0;  ///< voxel edge if a surface has to be built [m]; 0 = from the character's thickness
  int threads = 0;          ///< 0 = all hardware threads; the result does not depend on it
  std::function<bool(int done, int steps)> progress = {};  ///< return false to cancel
};

/// Distances between a body and the surface that it was built from, in one pose; all 0 if no surface was built.
struct BodyDistances {
  double farthestOutside = 0.0;  ///< largest distance of a visible vertex outside the body [m]
  double meanOutside = 0.0;      ///< mean over evenly spread points of the visible surface; those inside count as 0 [m]
  double meanToOriginal = 0.0;   ///< mean distance from the body's surface to the visible surface [m]
  double farthestToOriginal = 0.0;  ///< largest such distance, body vertices included [m]
};

/// A character that can be decomposed.
struct ClosedBody {
  /// `mesh.triangles` is a closed two-manifold. Vertices: first those of the body; then, if a surface had to be built,
  /// the character's own, which no triangle of the body uses: they are skinned and covered by the hulls, but not
  /// decomposed. `shown` has the visible triangles. Skeleton and inverse bind matrices are the character's.
  Character character;

  bool made = false;               ///< a surface had to be built: the character's own is not closed or not one solid
  int bodyVertices = 0;            ///< how many of character.mesh.vertices, the first ones
  double resolution = 0.0;         ///< voxel edge [m]; 0 if not made
  int shells = 0;                  ///< of the original, after welding
  int openEdges = 0;               ///< of the original, after welding
  int nonManifoldEdges = 0;        ///< of the original: edges with more than two triangles
  BodyDistances distances;         ///< in the bind pose
  std::vector<std::string> notes;  ///< what was welded, repaired, filled or dropped: one sentence each
};

/// Turns a character, as read from a file, into one that can be decomposed.
///
/// Equal vertices are welded, and a surface that is then a closed two-manifold is kept. Otherwise a closed, oriented
/// surface is built with an OpenVDB level set; its weights are transferred from the nearest point of the original
/// surface on the same limb, and smoothed.
/// @return the body; or an error if there are no triangles or they enclose nothing
[[nodiscard]] Result<ClosedBody> makeBody(const Character& character, const BodySettings& settings = {});

/// The distances in another pose, with both surfaces skinned.
/// @param worldFromModel  one per joint, see computeWorldFromModel()
[[nodiscard]] BodyDistances distancesInPose(const ClosedBody& body, std::span<const Affine3> worldFromModel);

}  // namespace lorica
