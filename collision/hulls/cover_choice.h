#pragma once

#include "acd/decomposition.h"
#include "acd/hull_budget.h"
#include "acd/hull_cover.h"
#include "collision/hulls/host.h"
#include "collision/live/choose_cover.h"
#include "skinning/character.h"

#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// Poses for choosing a cover, and separate poses for measuring it: see chooseCover().
struct CoverPoses {
  std::vector<Affine3> sampled;  ///< worldFromModel, poses x jointCount, pose-major
  std::vector<Affine3> heldOut;  ///< the same, of other poses
  int jointCount = 0;            ///< of the skeleton
  int randomPoses = 0;           ///< number of random poses at the end of each of the two lists

  /// Those that points are chosen in
  [[nodiscard]] BonePoseView sampledView() const { return {sampled, jointCount}; }
  /// Those that the choice is judged in
  [[nodiscard]] BonePoseView heldOutView() const { return {heldOut, jointCount}; }
};

/// Of the work that parts and a cover of theirs are: the parts, more or less.
inline constexpr double kPartsOfCover = 0.4;

/// Requirements on the hulls of a character's live body.
struct CoverRequest {
  std::optional<double> tolerance;  ///< [m]; 0 = exact
  int hullVertices = 0;             ///< maximum for each hull; 0 = no limit
  int hullPlanes = 0;  ///< the same, of hulls in one pose: those of a mesh, and a character's that are exported

  /// Whether the user asked for anything
  [[nodiscard]] bool given() const { return tolerance.has_value() || hullVertices > 0; }
  /// Whether every point is kept, so that nothing has to be chosen.
  [[nodiscard]] bool exact() const { return tolerance.value_or(0.0) == 0.0 && hullVertices == 0; }
  /// Of hulls in one pose
  [[nodiscard]] HullBudget budget() const { return {hullVertices, hullPlanes}; }
};

/// Rejects, before any work, a contradictory request or a tolerance that is out of range.
[[nodiscard]] Result<void> checkCover(const CoverRequest& request, const Character& character);

/// chooseCover() for a character, as a task of the host. Exact if nothing was requested.
/// @param decomposition  made from the character's mesh
[[nodiscard]] Result<HullCover> chooseCover(const Character& character, const Decomposition& decomposition,
                                            const CoverPoses& poses, const CoverRequest& request, Host& host);

/// Extra volume of a cover's hulls relative to exact ones (0.05 is 5 %), over all parts and every fourth sampled pose.
[[nodiscard]] double volumeGrowth(const Character& character, const Decomposition& decomposition,
                                  const CoverPoses& poses, const HullCover& cover);

/// "--cover 0.002 --hull-vertices 64 --hull-planes 18"
[[nodiscard]] std::string asTyped(const CoverRequest& request);

}  // namespace lorica
