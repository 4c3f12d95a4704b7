#pragma once

#include "acd/decomposition.h"
#include "acd/hull_cover.h"
#include "apps/command_line.h"
#include "apps/report.h"
#include "prepare/cover_choice.h"
#include "skinning/character.h"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>

namespace lorica {

/// --cover: `exact`, or a length above zero [m].
Option* addCover(CommandLine& app, std::optional<double>& tolerance, const std::string& description);

/// Rejects, before any work, a contradictory request or a tolerance that is out of range.
[[nodiscard]] Result<void> checkCover(const CoverRequest& request, const Character& character);

/// chooseCover() with a progress bar; Ctrl-C cancels. Exact if nothing was requested.
/// @param decomposition  made from the character's mesh
[[nodiscard]] Result<HullCover> chooseCoverWithProgress(const Character& character, const Decomposition& decomposition,
                                                        const CoverPoses& poses, const CoverRequest& request,
                                                        int threads);

/// "--cover 0.002 --hull-vertices 64"
[[nodiscard]] std::string asTyped(const CoverRequest& request);

/// Adds one to three lines that describe the cover.
/// @param cover  none = exact
void addCoverTo(Report& report, const std::optional<HullCover>& cover);
/// Adds "cover": its figures, lengths in metres.
void addCoverTo(nlohmann::ordered_json& json, const std::optional<HullCover>& cover);

}  // namespace lorica
