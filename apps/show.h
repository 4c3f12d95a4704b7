#pragma once

#include "apps/report.h"
#include "player/run.h"
#include "player/snapshots.h"
#include "player/window_opener.h"
#include "viewer/window/window.h"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// What play, live and replay share: a run on a screen or with pictures, and the end of its report.

/// Opens a window before there is a session.
[[nodiscard]] Result<Window> openWindow();

/// How a run was shown.
struct Showing {
  RunEnd end = RunEnd::kOver;
  DrawnFiles drawn;
  std::optional<Cast> next;  ///< the user opened it
};

/// Plays the run on the screen, or with the pictures without one.
/// @param screen  null = none @param opener  null = nothing else can be opened
[[nodiscard]] Result<Showing> show(Run& run, const SnapshotOptions& pictures, Screen* screen, WindowOpener* opener,
                                   Host& host);

/// "hero", or "3 avatars".
[[nodiscard]] std::string whoOf(const Run& run);

/// "avatars": character, frames and hash of each.
void addAvatarsTo(nlohmann::ordered_json& json, const Session& session);

/// "refusedLegs" and "smoothingDelay" of the first avatar.
void addSmoothingTo(nlohmann::ordered_json& json, const Session& session);
/// @param lag  "joints lag by"
void addSmoothingTo(Report& report, const Session& session, const std::string& lag);

/// Completes the files of a run and prints its report.
[[nodiscard]] Result<void> finishAndPublish(Run& run, const CommonOptions& common, Report& report,
                                            nlohmann::ordered_json& json);

}  // namespace lorica
