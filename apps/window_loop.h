#pragma once

#include "apps/playback.h"
#include "session/session.h"
#include "viewer/window.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// A session as a window shows it, and what is needed to do what people ask for there.
struct WindowSubject {
  Session& session;
  std::string name = {};
  double duration = 0.0;  ///< of a recording, from its first frame to its last [s]; 0 = live
  /// The recording from its start; null for a live source, which has no past to go back to.
  std::function<Result<std::unique_ptr<PoseSource>>()> sourceAnew = {};
  std::string scene = {};  ///< that the session's world is, as openScene() takes it
  /// The world of a recorded session, from its start. Where it is given the session is only watched: nothing is thrown
  /// or moved in it, and neither its scene nor its parts are exchanged.
  std::function<Result<World>()> worldAnew = {};
  std::function<bool()> ready = {};              ///< whether a step would not wait for joints; null = always
  std::function<void()> stepped = {};            ///< after each frame; null = nothing
  std::function<void()> restarted = {};          ///< before a first frame comes again; null = nothing
  std::function<std::string()> trouble = {};     ///< what is wrong with the source, in words; null or empty = nothing
  std::function<double()> trackingSeconds = {};  ///< what finding the joints took [s]; null = not timed
  std::function<bool()> enough = {};             ///< whether to stop after this frame; null = never
  const Image* inset = nullptr;                  ///< see Scene

  /// What happens at the end of the recording or of its limit.
  enum class AtEnd : std::uint8_t { kReturn, kHold, kRepeat };
  AtEnd atEnd = AtEnd::kHold;
};

/// Why the loop ended.
enum class WindowEnd : std::uint8_t { kClosed, kInterrupted, kOver };

/// Runs the session in the window and does what is asked for there, until the window is closed, Ctrl-C, or the end.
///
/// The session runs at the recording's pace, and no frame of it is left out: where pictures take long there are fewer
/// of them. Going back in time means to begin anew and run to the wanted frame without pictures; what was thrown and
/// moved by hand is done again in its frames, until something else is done.
/// @return why it ended, or what is wrong with the source's data
[[nodiscard]] Result<WindowEnd> runInWindow(Window& window, WindowSubject& subject, const PlaybackOptions& options);

}  // namespace lorica
