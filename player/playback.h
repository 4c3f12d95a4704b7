#pragma once

#include "session/session.h"

#include <string>

namespace lorica {

/// The note about PoseSource::refusedLegs().
inline constexpr const char* kRefusedLegs =
    "Legs that cannot be (they run upwards or change their length) were not used; without legs the character stands.";

/// The caption of a picture: name, time, contacts.
[[nodiscard]] std::string captionOf(const std::string& name, const Session& session, double seconds);

}  // namespace lorica
