#pragma once

#include "capture/skeleton_frame.h"

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// Reads Lorica's joint CSV (recordings/FORMAT.md) whole and checks it whole, the rows of every user.
/// @return frames of one user in time order, at least one: the user with the most frames, of equals the one seen
///         first; or a sentence with file, line, column, found and expected
[[nodiscard]] Result<std::vector<SkeletonFrame>> readJointCsv(const std::filesystem::path& file);

/// The same of text in memory. @param name  what the sentences call it
[[nodiscard]] Result<std::vector<SkeletonFrame>> parseJointCsv(std::string_view text, std::string_view name);

/// The frames of every user, in order of first appearance, each in time order.
[[nodiscard]] Result<std::vector<std::vector<SkeletonFrame>>> parseJointCsvOfAll(std::string_view text,
                                                                                 std::string_view name);

/// Writes it, whole or not at all. Reading it again gives the same numbers to the last bit, unless a
/// quaternion is off unit length by more than 1e-12: it is read normalised.
/// @param frames  at least one; refused when readJointCsv would refuse the file
[[nodiscard]] Result<void> writeJointCsv(const std::filesystem::path& file, std::span<const SkeletonFrame> frames);

/// The file's first line and one for a frame, each with its end, for whoever writes them as they come. A frame is not
/// checked.
[[nodiscard]] std::string jointCsvHeader();
[[nodiscard]] std::string jointCsvRow(const SkeletonFrame& frame);

/// A SkeletonSource over frames held in memory.
[[nodiscard]] std::unique_ptr<SkeletonSource> makeRecordedSource(std::vector<SkeletonFrame> frames);

}  // namespace lorica
