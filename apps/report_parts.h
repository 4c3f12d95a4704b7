#pragma once

#include "apps/report.h"
#include "viewer/player/run.h"
#include "viewer/player/snapshots.h"

#include <cstddef>
#include <optional>
#include <string>

namespace lorica {

/// Facts that several commands share.

/// "cover": one to three lines; lengths in metres.
/// @param cover         none = exact
/// @param volumeGrowth  none = not measured
[[nodiscard]] Facts coverFacts(const std::optional<HullCover>& cover,
                               const std::optional<double>& volumeGrowth = std::nullopt);

/// What was repaired in a mesh, and the closed body that was made for it: why, and how far it is from the original.
[[nodiscard]] Facts meshFacts(const Subject& subject);

/// "frames", "contacts", "touches", "propsTouched", "avatarTouches", and "selfContacts" of the first avatar; lines of
/// the self-contacts of each, if requested.
[[nodiscard]] Facts contactFacts(const RunStatistics& statistics);
/// Of an avatar: frames, pairs, and the deepest; null if not requested.
[[nodiscard]] Json selfContactsOf(const RunStatistics& statistics, std::size_t avatar);
/// The training range: a line; two if poses were outside it.
[[nodiscard]] Facts trainingFacts(const RunStatistics& statistics);
/// "stages": the median and p95 of each [us]. Lines below a heading.
[[nodiscard]] Facts stageFacts(const RunStatistics& statistics, const std::string& heading = "median");

/// "targets": of each its name, "hits", and those of each limb. A line for each target.
[[nodiscard]] Facts hitFacts(const TargetHits& targets);

/// What was seen by a camera's tracker; times in microseconds.
[[nodiscard]] Facts liveFacts(const LiveLog& log);
/// What a program sent of depth.
[[nodiscard]] Facts depthStreamFacts(const DepthStream& stream);
/// What a program sent.
[[nodiscard]] Facts streamFacts(const VmcInput& stream);
/// What was drawn to files.
[[nodiscard]] Facts drawnFacts(const DrawnFiles& drawn);

/// Finishes the recording of a run and adds the number of steps. Does nothing without a recorder.
[[nodiscard]] Result<void> finishRecorder(Run& run, const std::string& file, Report& report);

}  // namespace lorica
