#pragma once

#include "geometry/result.h"
#include "skinning/character.h"
#include "skinning/morphs/morphs.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// How a closed surface is made for a mesh that may be open or torn.
struct BodySettings {
  double resolution = 0.0;  ///< voxel edge if a surface has to be built [m]; 0 = from the character's thickness
  bool keepClosed = true;   ///< false: build a surface even if the character's own is closed
  bool keepThin = false;    ///< thicken what is thinner than a voxel; false: only limbs and rods, the rest is left out
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
  int reachedVertices = 0;         ///< how many, the last ones: positions that morph targets reach, see coverReached()
  double resolution = 0.0;         ///< voxel edge [m]; 0 if not made
  bool onlySheets = false;         ///< made from a surface that is nowhere the skin of a solid
  int shells = 0;                  ///< of the original, after welding
  int openEdges = 0;               ///< of the original, after welding
  int nonManifoldEdges = 0;        ///< of the original: edges with more than two triangles
  BodyDistances distances;         ///< in the bind pose
  std::string walls;               ///< which pieces are thin walls, in words; empty if none
  std::vector<std::string> notes;  ///< what was welded, repaired, filled or dropped: one sentence each
};

/// Turns a character, as read from a file, into one that can be decomposed.
///
/// Equal vertices are welded, and a surface that is then a closed two-manifold is kept. Otherwise a closed, oriented
/// surface is built with an OpenVDB level set; its weights are transferred from the nearest point of the original
/// surface on the same limb, and smoothed.
/// @return the body; or an error if there are no triangles or they enclose nothing
[[nodiscard]] Result<ClosedBody> makeBody(const Character& character, const BodySettings& settings = {});

/// How far positions that morph targets reach may lie outside a body before its hulls must grow [m].
inline constexpr double kReachTolerance = 0.002;

/// Adds to a body the positions that morph targets take vertices to, so that the hulls contain them: as vertices that
/// no triangle uses, after all others.
///
/// Positions that are held anyway are left out: those inside the body, inside the convex hull of the vertices that the
/// same joint moves most, such as a mouth inside the head, or less than kReachTolerance outside of either. A part may
/// be only a piece of such a hull; then a hollow between two parts is not filled. A note says what was added.
/// @param character  the one that the body was made from
/// @param reached    of its vertices
/// @return how many vertices were added
int coverReached(ClosedBody& body, const Character& character, std::span<const ReachedPosition> reached);

/// The distances in another pose, with both surfaces skinned.
/// @param worldFromModel  one per joint, see computeWorldFromModel()
[[nodiscard]] BodyDistances distancesInPose(const ClosedBody& body, std::span<const Affine3> worldFromModel);

}  // namespace lorica
