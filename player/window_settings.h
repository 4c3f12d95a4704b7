#pragma once

#include "geometry/result.h"
#include "viewer/renderer/window_values.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lorica {

/// What the window keeps from one run to the next.
struct WindowSettings {
  KeptChoices choices;
  std::map<std::string, bool> shown;  ///< layers of the picture that the user switched on or off, by name
  std::vector<std::string> recent;    ///< files that were opened, the last one first, at most kMaxRecent

  [[nodiscard]] bool operator==(const WindowSettings&) const = default;
};
inline constexpr std::size_t kMaxRecent = 10;

/// $XDG_CONFIG_HOME/lorica/window.json or ~/.config/lorica/window.json; empty if neither is an absolute path.
[[nodiscard]] std::filesystem::path windowSettingsFile();

/// @return the settings, the usual ones if there is no such file, or an error: file, found, expected
[[nodiscard]] Result<WindowSettings> readWindowSettings(const std::filesystem::path& file);
[[nodiscard]] Result<void> writeWindowSettings(const std::filesystem::path& file, const WindowSettings& settings);

/// Shows and hides the layers that the user switched on or off.
void showKept(const WindowSettings& settings, SceneOptions& show);
/// Keeps the layers that the user switched on or off.
void keepShown(const SceneOptions& before, const SceneOptions& now, WindowSettings& settings);

/// Puts a file first among the recent ones.
void addRecent(const std::string& file, WindowSettings& settings);

}  // namespace lorica
