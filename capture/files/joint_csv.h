#pragma once

#include "capture/skeleton_frame.h"

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// Reads and checks all of a file in Lorica's joint CSV format (recordings/FORMAT.md), including the rows of every
/// user.
/// @return frames of one user in time order, at least one: the user with the most frames, or the first of them in the
/// file if several have as many; or an error with file, line, column, found and expected
[[nodiscard]] Result<std::vector<SkeletonFrame>> readJointCsv(const std::filesystem::path& file);

/// Reads joint CSV text in memory. @param name  name of the text in error messages
[[nodiscard]] Result<std::vector<SkeletonFrame>> parseJointCsv(std::string_view text, std::string_view name);

/// Returns the frames of every user, users in order of first appearance, frames in time order.
[[nodiscard]] Result<std::vector<std::vector<SkeletonFrame>>> parseJointCsvOfAll(std::string_view text,
                                                                                 std::string_view name);

/// Writes joint CSV, completely or not at all. Reading it back gives bit-identical numbers, except for quaternions
/// whose length differs from 1 by more than 1e-12: these are normalised on reading.
/// @param frames  at least one; rejected if readJointCsv would reject the file
[[nodiscard]] Result<void> writeJointCsv(const std::filesystem::path& file, std::span<const SkeletonFrame> frames);

/// The header line and the line of one frame, each with its line end, for writing frames as they arrive. The frame is
/// not checked.
[[nodiscard]] std::string jointCsvHeader();
/// One frame as a line, without its end.
[[nodiscard]] std::string jointCsvRow(const SkeletonFrame& frame);

/// A SkeletonSource that reads from frames in memory.
[[nodiscard]] std::unique_ptr<SkeletonSource> makeRecordedSource(std::vector<SkeletonFrame> frames);

}  // namespace lorica
