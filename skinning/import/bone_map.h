#pragma once

#include "geometry/result.h"
#include "skinning/skeleton.h"

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

namespace lorica {

/// Which joint is which humanoid bone, as a person wrote or corrected it in a JSON file:
///
///     { "lorica": "bone map 1",
///       "character": "hero.glb",
///       "bones": { "hips": "Bip01 Pelvis", "spine": "Bip01 Spine", ..., "leftToes": null },
///       "unusedJoints": [ "Bip01", "Bip01 Tail" ] }
///
/// Where several joints have one name, a joint is called by its way down, as far as needed: "Neck/Head".
struct BoneMap {
  std::string character;                             ///< the file it was made for; for people only
  std::array<std::string, kHumanBoneCount> jointOf;  ///< name of each bone's joint; empty where there is none
};

/// Reads a bone map. Bones that it leaves out are null; comments after // and in /* */ are allowed.
/// @return the map; or a sentence with file, line or element, what was found and the nearest known spelling
[[nodiscard]] Result<BoneMap> readBoneMap(const std::filesystem::path& file);

/// The same from a file's whole content. @param name  of the file, for messages
[[nodiscard]] Result<BoneMap> parseBoneMap(std::string_view text, std::string_view name);

/// Writes the bones of a skeleton as a map to edit: all bones in VRM's order, null where there is none, then the names
/// of the joints that no bone uses, to copy from.
/// @param character  name of the file that the skeleton came from
[[nodiscard]] Result<void> writeBoneMap(const std::filesystem::path& file, const Skeleton& skeleton,
                                        std::string_view character);

/// The same skeleton with the bones of a map, and no others.
/// @param name  of the map, for messages
/// @return the skeleton; or which joint is not there (with the nearest name that is), is named by several, is two
///         bones, or does not hang on the bone above
[[nodiscard]] Result<Skeleton> applyBoneMap(const Skeleton& skeleton, const BoneMap& map, std::string_view name);

}  // namespace lorica
