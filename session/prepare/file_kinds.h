#pragma once

#include "geometry/result.h"

#include <cstdint>
#include <filesystem>

namespace lorica {

/// What a file is for Lorica.
enum class FileKind : std::uint8_t {
  kCharacter,  ///< or a motion without a character, in the same formats; or a mesh in several poses
  kBodyModel,  ///< a motion of SMPL and its kin
  kBvh,
  kJoints,
  kDepth,
  kPackets,
  kSession,
  kScene,
  kMesh,
  kDecomposition,
  kUnknown  ///< joints in a text of any name, or nothing that Lorica opens
};

/// By its name, and by its beginning where the name does not tell.
[[nodiscard]] FileKind kindOf(const std::filesystem::path& file);

/// Refuses, by its first bytes, a file that Lorica does not open: a picture, a film, a document, an archive, a program;
/// or one of Lorica's kinds under a wrong name. The message says what it is and what Lorica opens.
[[nodiscard]] Result<void> refuseOtherKinds(const std::filesystem::path& file);

/// Adds to an error that says what was found what Lorica opens.
[[nodiscard]] Error withWhatOpens(Error found);

}  // namespace lorica
