#pragma once

#include "acd/decomposition_file.h"
#include "prepare/springs.h"
#include "prepare/subject.h"
#include "session/session.h"
#include "viewer/renderer/scene.h"

#include <memory>
#include <optional>
#include <string>

namespace lorica {

/// Where an avatar performs and what its springs do.
struct AvatarSetting {
  std::optional<Isometry3> place = {};  ///< see SessionAvatar::setPlace()
  std::optional<SpringChoice> springs = {};
};

/// Adds an avatar to a session.
/// @param body    the decomposition, its cover (none = exact) and its training
/// @param source  moves the character
[[nodiscard]] Result<void> addAvatar(Session& session, const Character& character, const DecompositionFile& body,
                                     std::unique_ptr<PoseSource> source, const AvatarSetting& setting = {});

/// Creates a session of one character.
/// @param body    the decomposition, its cover (none = exact) and its training
/// @param source  moves the character
[[nodiscard]] Result<Session> startSession(const Character& character, const DecompositionFile& body,
                                           std::unique_ptr<PoseSource> source, World world);

/// Creates a session of one character and one motion, with the boxes and balls of the demo.
[[nodiscard]] Result<Session> startDemoSession(const Character& character, const DecompositionFile& body,
                                               const Motion& motion);

/// Options for playing a recording.
struct PlaybackOptions {
  int frames = 0;        ///< maximum number; 0 = no limit
  double seconds = 0.0;  ///< maximum duration [s]; 0 = no limit
  bool hurry = false;    ///< as fast as possible instead of in real time
};

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
