#pragma once

#include "apps/report.h"
#include "prepare/cover_choice.h"
#include "prepare/hull_fit.h"
#include "prepare/quality.h"
#include "prepare/subject.h"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// What the user asked `lorica decompose` for.
struct DecomposeOptions {
  std::string input;
  int parts = 0;              ///< 0 = not given
  double maxError = 0.0;      ///< 0 = not given
  double maxDistance = 0.0;   ///< 0 = not given
  double maxConcavity = 0.0;  ///< 0 = not given
  bool exact = false;         ///< until no concave edge is left
  int keyframes = 0;          ///< 0 = not given, kAuto = to be chosen
  std::vector<std::string> motions;
  CharacterOptions character;
  std::string body = "auto";
  std::string preset = "fast";
  int candidates = 0;    ///< 0 = the preset's
  int orientations = 0;  ///< 0 = the preset's
  CoverRequest cover;    ///< for a mesh, only the vertex limit is used
  bool heldOut = false;  ///< measure a character's error in other poses too
  std::string output;
  std::string obj;
  std::string picture;
};

/// Everything that `lorica decompose` found.
struct DecomposeOutcome {
  Fit fit;
  Keyframes keyframes;
  DecomposeSettings limits;
  double concavityUnit = 0.0;  ///< see concavityUnitOf()
  double coverVolume = 0.0;    ///< of a character's cover, relative to exact hulls: volumeGrowth()
  int threads = 0;
  std::optional<HeldOutError> heldOut = std::nullopt;  ///< if it was asked for
};

/// What the decomposition of a subject is, for machines and for people.
[[nodiscard]] nlohmann::ordered_json toJson(const DecomposeOptions& options, const Subject& subject,
                                            const DecomposeOutcome& outcome);
[[nodiscard]] Report toReport(const DecomposeOptions& options, const Subject& subject, const DecomposeOutcome& outcome);

}  // namespace lorica
