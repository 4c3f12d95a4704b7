#pragma once

#include "capture/registration/head_registration.h"
#include "geometry/result.h"

#include <filesystem>
#include <string_view>

namespace lorica {

/// Where a camera's registration is kept: $XDG_CONFIG_HOME/lorica/registrations/HASH.json or the same in ~/.config;
/// empty if neither is an absolute path.
/// @param camera  what tells it from others: its address, its serial number
[[nodiscard]] std::filesystem::path registrationFile(std::string_view camera);

/// @return the registration, exactly as it was saved, or an error: file, what was expected; kNotFound without a file
[[nodiscard]] Result<Registration> loadRegistration(const std::filesystem::path& file);
/// Replaces the file as a whole.
[[nodiscard]] Result<void> saveRegistration(const std::filesystem::path& file, const Registration& registration);

}  // namespace lorica
