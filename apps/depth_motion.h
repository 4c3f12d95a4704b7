#pragma once

#include "apps/motions.h"

#include <filesystem>

namespace lorica {

/// By its name, or by how it begins.
[[nodiscard]] bool isDepthRecording(const std::filesystem::path& file);

/// Follows whoever is in a depth recording (.oni), with a progress bar: every frame once, in order, the same joints
/// each time. Frames in which nobody is seen hold unknown joints.
/// @return the motion, or what is wrong with the file, or kCancelled
[[nodiscard]] Result<Motion> readDepthMotion(const std::filesystem::path& file, const MotionOptions& options);

}  // namespace lorica
