#pragma once

#include "session/session.h"
#include "viewer/renderer/screen.h"

#include <optional>
#include <string>

namespace lorica {

/// "hero performs walk"; live "hero follows camera"; "2 avatars perform walk and wave".
/// @param source  name of the motion or of what is followed
[[nodiscard]] std::string titleOf(const Session& session, const std::string& source, bool live);

/// The line of status of a screen: parts and touched props.
[[nodiscard]] std::string statusOf(const Session& session, bool ended);

/// Adds the last frame of a session to the screen's graph.
/// @param tracking  time for tracking the joints [s]; none = not measured
void addStageTimes(const Session& session, std::optional<double> tracking, Screen& screen);

/// The note about PoseSource::refusedLegs().
inline constexpr const char* kRefusedLegs =
    "Legs that cannot be (they run upwards or change their length) were not used; without legs the character stands.";

/// The caption of a picture: name, time, contacts.
[[nodiscard]] std::string captionOf(const std::string& name, const Session& session, double seconds);

}  // namespace lorica
