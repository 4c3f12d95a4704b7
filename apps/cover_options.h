#pragma once

#include "acd/decomposition.h"
#include "acd/hull_cover.h"
#include "apps/command_line.h"
#include "apps/report.h"
#include "session/prepare/cover_poses.h"
#include "skinning/character.h"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>

namespace lorica {

/// What --cover and --hull-vertices ask of a character's live body.
struct CoverRequest {
  std::optional<double> tolerance;  ///< [m]; 0 = exact
  int hullVertices = 0;             ///< 0 = no bound

  [[nodiscard]] bool given() const { return tolerance.has_value() || hullVertices > 0; }
  /// Every point is kept: nothing has to be chosen.
  [[nodiscard]] bool exact() const { return tolerance.value_or(0.0) == 0.0 && hullVertices == 0; }
};

/// --cover: `exact`, or a length above zero [m].
Option* addCover(CommandLine& app, std::optional<double>& tolerance, const std::string& description);

/// Refuses, before any work, a request that contradicts itself or that has the body swell beyond use.
[[nodiscard]] Result<void> checkCover(const CoverRequest& request, const Character& character);

/// chooseCover() with a progress bar; Ctrl-C cancels it. Exact where nothing was asked for.
/// @param decomposition  made from the character's mesh
[[nodiscard]] Result<CoverPromise> chooseCoverWithProgress(const Character& character,
                                                           const Decomposition& decomposition, const CoverPoses& poses,
                                                           const CoverRequest& request, int threads);

/// How much more volume the hulls of a cover hold than exact ones: 0.05 is 5 %, of the sums over the parts and every
/// fourth sampled pose.
[[nodiscard]] double volumeGrowth(const Character& character, const Decomposition& decomposition,
                                  const CoverPoses& poses, const CoverPromise& cover);

/// One to three lines that say what is promised.
/// @param cover  none = exact
void addCoverTo(Report& report, const std::optional<CoverPromise>& cover);
/// "cover": what is promised, lengths in metres.
void addCoverTo(nlohmann::ordered_json& json, const std::optional<CoverPromise>& cover);

}  // namespace lorica
