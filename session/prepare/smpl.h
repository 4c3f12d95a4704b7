#pragma once

#include "geometry/result.h"
#include "session/prepare/motion.h"
#include "skinning/import/character_file.h"

#include <filesystem>

namespace lorica {

/// What a .npz holds for Lorica, by the names of its arrays.
enum class ArchiveKind : std::uint8_t {
  kOther,       ///< a mesh in several poses, or something else
  kSmplMotion,  ///< `poses` and `trans`, as AMASS has them
  kSmplModel,   ///< `v_template`, `weights`, `kintree_table`, ...
};
/// @return kOther for what cannot be read
[[nodiscard]] ArchiveKind archiveKindOf(const std::filesystem::path& file);

/// Reads a motion of SMPL, SMPL-H or SMPL-X: joint rotations (axis and angle) of 22, 24, 52 or 55 joints, `trans`, and
/// a rate (`mocap_framerate`, `mocap_frame_rate` or `fps`). The bones are as long as the mannequin's: the file has no
/// lengths, only numbers of a model (`betas`).
/// Loper et al. 2015, Romero et al. 2017, Pavlakos et al. 2019; https://amass.is.tue.mpg.de
[[nodiscard]] Result<Motion> readSmplMotion(const std::filesystem::path& file);

/// Reads a body model of the user's own: its mean shape, or that of `betas` if the file has them too, its joints and
/// skin, and the first 16 of `shapedirs` as morph targets. Pose-dependent shapes (`posedirs`) are left out. It is put
/// on the floor.
[[nodiscard]] Result<CharacterFile> readSmplModel(const std::filesystem::path& file);

}  // namespace lorica
