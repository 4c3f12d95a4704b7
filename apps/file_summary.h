#pragma once

#include "apps/report.h"
#include "session/prepare/subject.h"

#include <filesystem>
#include <string>

namespace lorica {

/// What `lorica info` says of a file.

[[nodiscard]] Report describeMesh(const Subject& subject);
/// @param textureSize  see CharacterOptions
[[nodiscard]] Report describeCharacter(const Subject& subject, int textureSize);
/// @param file  a .lorica file
[[nodiscard]] Result<Report> describeDecomposition(const std::filesystem::path& file);

}  // namespace lorica
