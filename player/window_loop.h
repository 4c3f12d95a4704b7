#pragma once

#include "player/playback.h"
#include "player/window_opener.h"
#include "prepare/treatment.h"
#include "session/session.h"
#include "viewer/window/window.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// A session shown in a window, and the callbacks that the window's controls need.
struct WindowSubject {
  Session& session;
  std::string name = {};
  double duration = 0.0;  ///< of a recording, from its first to its last frame [s]; 0 = live
  /// Reopens the recordings of all avatars at their start; null for live sources.
  std::function<Result<std::vector<std::unique_ptr<PoseSource>>>()> sourcesAgain = {};
  std::string scene = {};  ///< of the session's world, as passed to openScene()
  /// Recreates the world of a recorded session at its start. If set, the session is view-only: the user cannot throw or
  /// move anything, nor change the scene or the number of parts.
  std::function<Result<World>()> worldAgain = {};
  std::function<bool()> ready = {};      ///< whether joints are available for a step; null = always
  std::function<void()> stepped = {};    ///< called after each frame; may be null
  std::function<void()> restarted = {};  ///< called before the first frame is repeated; may be null
  std::function<void(const std::string& scene)> sceneChosen = {};  ///< with its argument of openScene(); may be null
  std::function<std::string()> trouble = {};                       ///< problem with the source; null or empty = none
  std::function<double()> trackingSeconds = {};  ///< time for tracking the joints [s]; null = not measured
  std::function<bool()> enough = {};             ///< whether to stop after the current frame; null = never
  WindowOpener* opener = nullptr;  ///< opens files that are dropped on the window; null = they cannot be opened
  std::vector<Prop> added = {};    ///< props in each of its worlds, in addition to those of the scene
  std::function<std::span<const TargetScore>()> hits = {};  ///< of the scene's targets; null = none
  TreatmentControl treatment = {};                          ///< mirror, smoothing, gravity
  const Image* inset = nullptr;                             ///< see Scene
  std::optional<LoadedCast> next = {};                      ///< see WindowEnd::kExchanged

  /// Behaviour at the end of the recording or at its limit.
  enum class AtEnd : std::uint8_t {
    kReturn,
    kHold,    ///< the last frame stays
    kChoice,  ///< as the user chose in the window: it starts again, or the world goes on around the last pose
    kRepeat
  };
  AtEnd atEnd = AtEnd::kChoice;
};

/// Reason for the end of the loop.
enum class WindowEnd : std::uint8_t {
  kClosed,
  kInterrupted,
  kOver,
  kExchanged  ///< the user opened something else, which is in WindowSubject::next
};

/// Runs the session in the window and handles the window's controls, until the window is closed, Ctrl-C, or the end.
///
/// The session runs in real time and skips no frame: if drawing is slow, fewer pictures are drawn. Going back in time
/// restarts the session and runs it to the requested frame without pictures; recorded user actions are repeated in
/// their frames until the user does something else.
/// @return why it ended, or an error about the source's data
[[nodiscard]] Result<WindowEnd> runInWindow(Window& window, WindowSubject& subject, const PlaybackOptions& options);

}  // namespace lorica
