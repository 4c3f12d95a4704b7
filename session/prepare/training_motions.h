#pragma once

#include "collision/hulls/training.h"
#include "session/prepare/motion.h"
#include "session/prepare/read_motion.h"
#include "session/prepare/subject.h"

#include <span>
#include <string>
#include <vector>

namespace lorica {

/// The given motions; if there are none, the character's own clips and, for a humanoid, the motions that Lorica ships,
/// since it may be moved by either; else its rest pose.
/// @param given  may be empty
/// @param clips  of the character's skeleton; may be empty
[[nodiscard]] Result<Training> trainingMotions(const Character& character, std::span<const Motion> given,
                                               std::span<const Clip> clips);

/// Reads motions by paths or names, see readMotion().
[[nodiscard]] Result<std::vector<Motion>> readMotions(std::span<const std::string> names, Host& host);

/// The same for a subject.
/// @param motions  may be empty
[[nodiscard]] Result<Training> trainingMotions(const Subject& subject, std::span<const Motion> motions);

}  // namespace lorica
