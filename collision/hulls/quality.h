#pragma once

#include "acd/decomposition.h"
#include "acd/hull_cover.h"
#include "collision/hulls/cover_choice.h"
#include "collision/hulls/file_content.h"
#include "skinning/character.h"

#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// How closely a decomposition's hulls fit the mesh, as means over poses; a mesh has one pose.
struct Quality {
  double meshVolume = 0.0;  ///< [cubed units of the mesh; m^3 for a character]
  double hullVolume = 0.0;  ///< sum over the parts
  double score = 0.0;       ///< mesh volume / hull volume: Thul et al. 2018, Eq. 17
  double error = 0.0;       ///< (hull volume - mesh volume) / mesh volume
  std::vector<double> errorPerKeyframe;
};

/// Means of the volumes, of the score and of the error over the keyframes.
/// @param hulls  in each keyframe
[[nodiscard]] Quality measureQuality(const TriMesh& mesh, PoseView keyframes, const UsedHulls& hulls);

/// What everybody is told of hulls with more than half as much volume again as their mesh.
/// @param error  see Quality
/// @return a sentence; "" for a smaller error
[[nodiscard]] std::string doubtAboutHulls(double error);

/// Largest distance of the hulls from the surface of their parts, over all keyframes: an upper bound that is at most 1
/// % too large. Distances below `ignoreBelow` are not resolved [mesh units; m for a character].
/// @param hulls  of the parts, in each keyframe
[[nodiscard]] double measureDistance(const Decomposition& decomposition, PoseView keyframes, const UsedHulls& hulls,
                                     double ignoreBelow);

/// Largest and mean concavity of the parts, see partConcavity(), with their hulls that are used [mesh units].
struct Concavity {
  double largest = 0.0;
  double mean = 0.0;  ///< over the parts, in the keyframe where it is largest
};
[[nodiscard]] Concavity measureConcavity(const Decomposition& decomposition, PoseView keyframes, const UsedHulls& hulls,
                                         double ignoreBelow);

/// How closely live hulls fit a body in poses that its parts were not trained on.
struct HeldOutError {
  double error = 0.0;  ///< mean of (hull volume - body volume) / body volume
  int poses = 0;
};

/// Measures it in every fourth held-out pose: half of them from the motions, half random within joint limits.
/// @param cover  none = exact
[[nodiscard]] HeldOutError heldOutError(const Character& character, const Decomposition& decomposition,
                                        const std::optional<HullCover>& cover, const CoverPoses& poses);

}  // namespace lorica
