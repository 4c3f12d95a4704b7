#pragma once

#include "player/warning_board.h"
#include "session/session.h"

#include <string>
#include <string_view>

namespace lorica {

/// Raises warnings about a frame: lost limbs and problems with the source.
/// @param trouble  problem with the source; empty = none
/// @param now      monotonic time [s]
void raiseWarnings(const Session& session, std::string_view trouble, double now, WarningBoard& board);

/// Names of the limbs with low trust: "left hand, left lower arm lost". If there are more than three, the first three
/// and the number of the others; empty if there are none.
/// @param trust  one value per joint, see PoseSource::trust(); empty = all are trusted
[[nodiscard]] std::string lostLimbs(const Skeleton& skeleton, std::span<const double> trust);

}  // namespace lorica
