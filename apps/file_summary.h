#pragma once

#include "apps/report.h"
#include "prepare/motion.h"
#include "prepare/subject.h"
#include "skinning/import/character_file.h"
#include "skinning/look/look.h"

#include <nlohmann/json.hpp>

#include <span>

namespace lorica {

/// The output of `lorica info` for a file, as text and as JSON.
struct FileSummary {
  Report report;
  nlohmann::ordered_json json;
};

[[nodiscard]] FileSummary describeMesh(const Subject& subject);
/// @param textureSize  see CharacterOptions
[[nodiscard]] FileSummary describeCharacter(const Subject& subject, int textureSize);
/// @param file  a .lorica file
[[nodiscard]] Result<FileSummary> describeDecomposition(const std::filesystem::path& file);
[[nodiscard]] FileSummary describeMotion(const Motion& motion);
/// @param file  an .oni file
[[nodiscard]] Result<FileSummary> describeDepthRecording(const std::filesystem::path& file);
/// The depth cameras that OpenNI2 finds and their drivers; if there are none, the reasons.
/// @param driver  file of an additional driver; empty = none
[[nodiscard]] Result<FileSummary> describeDevices(const std::string& driver);

/// Names of meshes for `lorica info`, as --hide takes them.
void describeMeshNames(std::span<const MeshName> meshes, Report& report, nlohmann::ordered_json& json);

/// Materials and pictures for `lorica info`, and the memory of the textures.
/// @param textureSize  largest side of textures [pixels]; 0 = as stored
void describeLook(const Look& look, int textureSize, Report& report, nlohmann::ordered_json& json);

}  // namespace lorica
