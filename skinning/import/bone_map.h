#pragma once

#include "geometry/result.h"
#include "skinning/humanoid/humanoid.h"
#include "skinning/skeleton.h"

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// The joint of each humanoid bone, as written or corrected by a user in a JSON file:
///
///     { "lorica": "bone map 1",
///       "character": "hero.glb",
///       "bones": { "hips": "Bip01 Pelvis", "spine": "Bip01 Spine", ..., "leftToes": null },
///       "unsure": { "leftHand": "the arms are not alike" },
///       "unusedJoints": [ "Bip01", "Bip01 Tail" ] }
///
/// If several joints have one name, a joint is given by as much of its path as needed: "Neck/Head".
struct BoneMap {
  std::string character;                             ///< the file it was made for; for information only
  std::array<std::string, kHumanBoneCount> jointOf;  ///< name of each bone's joint; empty if there is none
};

/// Reads a bone map. Missing bones are null; comments after // and in /* */ are allowed.
/// @return the map; or an error with file, line or element, what was found and the most similar known name
[[nodiscard]] Result<BoneMap> readBoneMap(const std::filesystem::path& file);

/// Parses the content of a bone map. @param name  of the file, for messages
[[nodiscard]] Result<BoneMap> parseBoneMap(std::string_view text, std::string_view name);

/// Writes the bones of a skeleton as a map to edit: all bones in VRM's order, null if there is none, then those that
/// may be wrong, if any, and the names of the joints that no bone uses, to copy from.
/// @param character  name of the file that the skeleton came from
/// @param doubts     of its bones
[[nodiscard]] Result<void> writeBoneMap(const std::filesystem::path& file, const Skeleton& skeleton,
                                        std::string_view character, std::span<const BoneDoubt> doubts = {});

/// The same skeleton with exactly the bones of a map.
/// @param name  of the map, for messages
/// @return the skeleton; or an error with the joint that does not exist (and the most similar name), whose name is
///         ambiguous, that is assigned to two bones, or that is not below the parent bone's joint
[[nodiscard]] Result<Skeleton> applyBoneMap(const Skeleton& skeleton, const BoneMap& map, std::string_view name);

}  // namespace lorica
