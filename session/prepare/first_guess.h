#pragma once

#include "geometry/math.h"
#include "session/prepare/motion.h"
#include "skinning/import/character_file.h"

#include <string>
#include <vector>

namespace lorica {

/// What a file was taken to be, for one line of a report: rest pose, unit, axes, floor and facing.
/// @param guess  what the reader took for granted; completed by where the body looks first and, of bones, by where its
///               floor is
[[nodiscard]] std::string firstGuessOf(std::vector<std::string> guess, const Motion& motion);

/// The same of a character: its pose, its size, where it looks and where it stands.
[[nodiscard]] std::string firstGuessOf(const CharacterFile& file);

/// "+Z", or "35 degrees from +Z towards +X". @param ahead  a direction along the floor
[[nodiscard]] std::string wayInWords(const Vec3& ahead);

}  // namespace lorica
