#pragma once

#include "apps/inputs.h"
#include "apps/report.h"

#include <nlohmann/json.hpp>

namespace lorica {

/// What `lorica info` says about a file, for people and for programs.
struct Facts {
  Report report;
  nlohmann::ordered_json json;
};

[[nodiscard]] Facts describeMesh(const Subject& subject);
[[nodiscard]] Facts describeCharacter(const Subject& subject);
/// @param file  a .lorica file
[[nodiscard]] Result<Facts> describeDecomposition(const std::filesystem::path& file);
[[nodiscard]] Facts describeMotion(const Motion& motion);
/// @param file  an .oni file
[[nodiscard]] Result<Facts> describeDepthRecording(const std::filesystem::path& file);
/// The depth cameras that OpenNI2 sees, through which drivers; where there are none, why.
/// @param driver  file of a driver to add; empty = none
[[nodiscard]] Result<Facts> describeDevices(const std::string& driver);

}  // namespace lorica
