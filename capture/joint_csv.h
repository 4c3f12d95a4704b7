#pragma once

#include "capture/skeleton_frame.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// Reads Lorica's joint CSV (recordings/FORMAT.md) whole and checks it whole.
/// @return frames in time order, at least one, or a sentence with file, line, column, found and expected
[[nodiscard]] Result<std::vector<SkeletonFrame>> readJointCsv(const std::filesystem::path& file);

/// Writes it, whole or not at all.
[[nodiscard]] Result<void> writeJointCsv(const std::filesystem::path& file, std::span<const SkeletonFrame> frames);

/// A SkeletonSource over frames held in memory.
[[nodiscard]] std::unique_ptr<SkeletonSource> makeRecordedSource(std::vector<SkeletonFrame> frames);

}  // namespace lorica
