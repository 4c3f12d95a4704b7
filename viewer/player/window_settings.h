#pragma once

#include "geometry/result.h"
#include "session/prepare/read_motion.h"
#include "viewer/renderer/window_values.h"

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// How the user may change the treatment of a window's session while it runs.
struct TreatmentControl {
  Treatment first = {};  ///< of the session as it was made
  // Why one stays as it was made, whatever the user has kept; empty = it can be changed. With static storage duration.
  std::string_view noMirror = {};
  std::string_view noSmoothing = {};
  std::string_view noGravity = {};

  /// Everything stays as it was made.
  void fix(std::string_view why) { noMirror = noSmoothing = noGravity = why; }
};

/// Mirror and smoothing that were given with the command stay so.
/// @param tracked  whether there are joints to be smoothed
[[nodiscard]] TreatmentControl treatmentControl(const MotionOptions& options, bool tracked);

/// What stays as it was made stays so in the user's choice.
[[nodiscard]] Treatment allowed(const TreatmentControl& control, Treatment chosen);

/// The options with a window's mirror and smoothing.
[[nodiscard]] MotionOptions treated(MotionOptions options, const Treatment& treatment);

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
