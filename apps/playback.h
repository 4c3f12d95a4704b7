#pragma once

#include "acd/decomposition_file.h"
#include "apps/inputs.h"
#include "session/session.h"
#include "viewer/scene.h"

#include <memory>
#include <string>

namespace lorica {

/// A session of one character.
/// @param body    the decomposition, its cover (none = exact) and its training
/// @param source  moves the character
[[nodiscard]] Result<Session> startSession(const Character& character, const DecompositionFile& body,
                                           std::unique_ptr<PoseSource> source, World world);

/// The same: the character performs one motion among the demo's boxes and balls.
[[nodiscard]] Result<Session> startDemoSession(const Character& character, const DecompositionFile& body,
                                               const Motion& motion);

/// How a recording is played.
struct PlaybackOptions {
  int frames = 0;        ///< stop after so many; 0 = no limit
  double seconds = 0.0;  ///< of the recording [s]; 0 = no limit
  bool hurry = false;    ///< does not wait for the recording's pace
};

/// Where a window looks from at first: the whole of a shipped recording stays in the picture.
/// @param height  of the character [m]
[[nodiscard]] Camera windowCamera(double height);

/// One line under a picture: what plays, when, what touches, and whether the pose is one that training did not know.
[[nodiscard]] std::string captionOf(const std::string& name, const Session& session, double seconds);

}  // namespace lorica
