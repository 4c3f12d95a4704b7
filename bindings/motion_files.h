#pragma once

#include "prepare/motion.h"

#include <string>
#include <vector>

namespace lorica {

/// The recordings that Lorica ships without noise, made again: equal to the files, bit for bit.
[[nodiscard]] std::vector<Motion> shippedMotions();

/// Reads a motion from a file of joints, BVH or a character's clips; or makes a shipped one, by its name.
/// @param clip  of a character file with several; empty = the first
[[nodiscard]] Result<Motion> readMotionNamed(const std::string& nameOrFile, const std::string& clip);

}  // namespace lorica
