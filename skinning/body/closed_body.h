#pragma once

#include "geometry/result.h"
#include "skinning/character.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

struct BodySettings {
  double resolution = 0.0;  ///< edge of a voxel where a surface has to be made [m]; 0 = from the character's thickness
  int threads = 0;          ///< 0 = as many as the machine has; the result does not depend on it
  std::function<bool(int done, int steps)> progress = {};  ///< return false to cancel
};

/// How far a body and the surface that it was made of are from each other, in one pose; all 0 where it was not made.
struct BodyDistances {
  double farthestOutside = 0.0;  ///< of any vertex that people see, from the body, where it lies outside [m]
  double meanOutside = 0.0;      ///< mean over points spread evenly over what people see; those inside count as 0 [m]
  double meanToOriginal = 0.0;   ///< mean distance from the body's surface to what people see [m]
  double farthestToOriginal = 0.0;  ///< the same, the farthest of the points and of the body's vertices
};

/// A character that can be decomposed.
struct Body {
  /// `mesh.triangles` is a closed two-manifold. Vertices: first those of the body, then, where a surface had to be
  /// made, the character's own, which no triangle of the body uses: they are skinned and covered but not cut. `shown`
  /// has the triangles that people see. Skeleton and inverse bind matrices are the character's.
  Character character;

  bool made = false;               ///< a surface had to be made: the character's own is not closed, or not one body
  int bodyVertices = 0;            ///< the first of character.mesh.vertices
  double resolution = 0.0;         ///< of the voxels [m]; 0 when not made
  int shells = 0;                  ///< of the original, after welding
  int openEdges = 0;               ///< of the original, after welding
  int crowdedEdges = 0;            ///< of the original: edges of more than two triangles
  BodyDistances distances;         ///< in the bind pose
  std::vector<std::string> notes;  ///< what was welded, mended, filled or dropped: one sentence each
};

/// Makes of a character, as read from a file, one that can be decomposed.
///
/// Equal vertices are welded, and a surface that is then a closed two-manifold stays as it is. Otherwise a closed,
/// oriented surface is made with an OpenVDB level set, its weights carried over from the nearest point of the original
/// surface on the same limb, and smoothed.
/// @return the body, or why there is none: no triangles, or nothing of them encloses anything
[[nodiscard]] Result<Body> makeBody(const Character& character, const BodySettings& settings = {});

/// The same distances in another pose, both surfaces skinned.
/// @param worldFromModel  one a joint, see computeWorldFromModel()
[[nodiscard]] BodyDistances distancesInPose(const Body& body, std::span<const Affine3> worldFromModel);

}  // namespace lorica
