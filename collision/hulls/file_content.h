#pragma once

#include "acd/decomposition_file.h"
#include "acd/hull_cover.h"
#include "collision/hulls/subject.h"
#include "collision/hulls/training.h"
#include "collision/live/choose_cover.h"
#include "geometry/convex_hull.h"
#include "skinning/character.h"

#include <filesystem>
#include <string>
#include <vector>

namespace lorica {

/// The hulls that are used, for figures about them: one list of the parts' hulls for each pose.
using UsedHulls = std::vector<std::vector<ConvexHull>>;

/// The hulls that a live body of this cover has in some poses of its bones.
[[nodiscard]] UsedHulls liveHulls(const Character& character, const Decomposition& decomposition,
                                  const HullCover& cover, BonePoseView poses);

/// The content of a .lorica file for a new decomposition: levels of detail evaluated in the keyframes, the training
/// range, and the bones that move each part; no cover. The training range contains all frames of the training motions;
/// of more than 3,000 frames, that many at even intervals are considered.
/// @param character  null for a mesh, as is training
/// @param hulls      those that are used, of the parts, in each keyframe
[[nodiscard]] DecompositionFile fileContent(const std::string& name, const TriMesh& mesh, const Character* character,
                                            const Training* training, PoseView keyframes, Decomposition decomposition,
                                            const UsedHulls& hulls);

/// An error if parts were made from another mesh. @param from  where they are from: the name of a file
[[nodiscard]] Result<void> checkMadeFrom(const Subject& subject, const DecompositionFile& content,
                                         const std::string& from);

/// The decomposition in a .lorica file, or an error if it was made from another mesh or cannot be read.
[[nodiscard]] Result<DecompositionFile> readDecompositionOf(const Subject& subject, const std::filesystem::path& file);

}  // namespace lorica
