#pragma once

#include "session/session.h"
#include "viewer/warning_board.h"

#include <string>
#include <string_view>

namespace lorica {

/// What is wrong with a frame, for people: limbs that are not believed, a pose that training did not know, and what is
/// wrong with the source.
/// @param trouble  with the source; empty = none
/// @param now      a clock that never goes back [s]
void raiseWarnings(const Session& session, std::string_view trouble, double now, WarningBoard& board);

/// Names of the limbs that are not believed: "left hand, left lower arm lost"; of more than three the first and how
/// many more; empty where there are none.
/// @param trust  one a joint, see PoseSource::trust(); empty = all are believed
[[nodiscard]] std::string lostLimbs(const Skeleton& skeleton, std::span<const double> trust);

}  // namespace lorica
