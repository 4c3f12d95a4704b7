#pragma once

#include "apps/report.h"
#include "player/run.h"
#include "player/snapshots.h"

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <optional>
#include <string>

namespace lorica {

/// Adds one to three lines that describe the cover.
/// @param cover  none = exact
void addCoverTo(Report& report, const std::optional<HullCover>& cover);
/// Adds "cover": its figures, lengths in metres.
void addCoverTo(nlohmann::ordered_json& json, const std::optional<HullCover>& cover);

/// The numbers of springs, joints, colliders and constraints for `lorica info`.
void describeSprings(const SpringBones& springs, Report& report, nlohmann::ordered_json& json);

/// What was repaired in a mesh, and the closed body that was made for it: why, and how far it is from the original.
void addMeshTo(Report& report, const Subject& subject);
void addMeshTo(nlohmann::ordered_json& json, const Subject& subject);

/// "frames", "contacts", "touches", "propsTouched", "avatarTouches", "selfContacts" of the first avatar, "training" and
/// "stages": the median and p95 of each stage [us].
void addStatisticsTo(nlohmann::ordered_json& json, const RunStatistics& statistics);
/// A line for each stage.
void addStatisticsTo(Report& report, const RunStatistics& statistics);
/// Of an avatar: frames, pairs, and the deepest; null if not requested.
[[nodiscard]] nlohmann::ordered_json selfContactsOf(const RunStatistics& statistics, std::size_t avatar);
/// A line on the self-contacts of each avatar, if requested.
void addSelfContactsTo(Report& report, const RunStatistics& statistics);
/// A line on the training range; two if poses were outside it.
void addTrainingTo(Report& report, const RunStatistics& statistics);

/// "targets": of each its name, "hits", and those of each limb.
void addHitsTo(nlohmann::ordered_json& json, const TargetHits& targets);
/// A line for each target.
void addHitsTo(Report& report, const TargetHits& targets);

/// What was seen by a camera's tracker; times in microseconds.
void addLiveTo(nlohmann::ordered_json& json, const LiveLog& log);
void addLiveTo(Report& report, const LiveLog& log);
/// What a program sent.
void addStreamTo(nlohmann::ordered_json& json, const VmcInput& stream);
void addStreamTo(Report& report, const VmcInput& stream);
/// What was drawn to files.
void addDrawnTo(nlohmann::ordered_json& json, const DrawnFiles& drawn);
void addDrawnTo(Report& report, const DrawnFiles& drawn);

/// Finishes the recording of a run and adds the number of steps. Does nothing without a recorder.
[[nodiscard]] Result<void> finishRecorder(Run& run, const std::string& file, Report& report,
                                          nlohmann::ordered_json& json);

}  // namespace lorica
