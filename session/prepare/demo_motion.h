#pragma once

#include "session/prepare/cast.h"

namespace lorica {

/// The motion of the demo: excerpts of shipped recordings, concatenated and cross-faded. Each starts at the position of
/// the feet at the end of the previous one. Frames at 30 Hz from time 0.
/// @return joints named "kick and walk", or an error if a shipped recording cannot be read
[[nodiscard]] Result<Motion> makeDemoMotion(Host& host);

/// The demo: a humanoid, that motion, boxes and balls. Another character performs its own clip, or stands.
struct DemoCast {
  Cast cast;
  std::optional<bool> fromCache;  ///< the decomposition; not known with a scene
  double seconds = 0.0;           ///< of computing it
};
/// @param scene  played instead, with its own avatars; empty = none. See readSceneText()
[[nodiscard]] Result<DemoCast> prepareDemo(const std::string& character, const std::string& scene, Host& host);

/// What the mannequin does in a scene without avatars, and a character that is dropped on the demo.
inline constexpr const char* kDemoCharacterMotion = "punch_and_kick";

}  // namespace lorica
