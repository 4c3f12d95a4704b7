#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace lorica {

/// What a VRM file says against giving it to others, as everybody who sees the page gets it; empty = nothing.
/// https://github.com/vrm-c/vrm-specification: VRMC_vrm-1.0/meta.md and `meta` in 0.0/README.md
/// @param document  the glTF document
[[nodiscard]] std::string vrmLicence(const nlohmann::ordered_json& document);

}  // namespace lorica
