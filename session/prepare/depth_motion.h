#pragma once

#include "session/prepare/read_motion.h"

#include <filesystem>
#include <string>

namespace lorica {

/// Tracks a person in a depth recording, see openDepthRecording(), and reports how far that is. Every frame is used
/// once, in order; the result is deterministic. All joints are unknown in frames without a person.
/// @return the motion, an error about the file, or kCancelled
[[nodiscard]] Result<Motion> readDepthMotion(const std::filesystem::path& file, const MotionOptions& options,
                                             Host& host);

/// Where a recording's floor is and where the first person looks, in a line for reports: by its first three seconds at
/// most.
[[nodiscard]] Result<std::string> firstGuessOfDepth(const std::filesystem::path& file, const std::string& lens = {});

/// readDepthMotion() of everyone, see PeoplePlaces: a motion for each place that was taken.
[[nodiscard]] Result<std::vector<Motion>> readDepthMotionOfAll(const std::filesystem::path& file,
                                                               const std::string& lens, Host& host);

/// Tracks everyone in a depth recording and writes where they are in front of the camera, see TrackLog: the
/// joints to `base`.cam.csv and the labels of the pixels to `base`.lab.
/// @return the number of frames, or an error about a file, or kCancelled
[[nodiscard]] Result<int> writeTrackLog(const std::filesystem::path& file, const std::string& lens,
                                        const std::filesystem::path& base, Host& host);

}  // namespace lorica
