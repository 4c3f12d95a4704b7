#pragma once

#include "session/session.h"
#include "viewer/renderer/scene.h"

#include <cstddef>
#include <string>

namespace lorica {

/// The note about PoseSource::refusedLegs().
inline constexpr const char* kRefusedLegs =
    "Legs that cannot be (they run upwards or change their length) were not used; without legs the character stands.";

/// The initial camera of a window: it keeps the whole of a shipped recording in view.
/// @param height   of the character [m]
/// @param avatars  that stand side by side
[[nodiscard]] Camera windowCamera(double height, std::size_t avatars = 1);

/// The caption of a picture: name, time, contacts.
[[nodiscard]] std::string captionOf(const std::string& name, const Session& session, double seconds);

}  // namespace lorica
