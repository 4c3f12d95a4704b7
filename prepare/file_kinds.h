#pragma once

#include "geometry/result.h"

#include <filesystem>

namespace lorica {

/// Refuses, by its first bytes, a file that Lorica does not open: a picture, a film, a document, an archive, a program.
/// The message says what it is and what Lorica opens.
[[nodiscard]] Result<void> refuseOtherKinds(const std::filesystem::path& file);

/// Whether a file begins as a JSON file of recorded joints; other .json files are scenes.
[[nodiscard]] bool isJointJson(const std::filesystem::path& file);

}  // namespace lorica
