#pragma once

#include "apps/playback.h"
#include "apps/snapshots.h"
#include "apps/window_loop.h"

#include <functional>
#include <string>

namespace lorica {

/// Refuses --window where there is no display.
/// @param instead  what to do then, for the sentence
[[nodiscard]] Result<void> checkWindow(bool wanted, const std::string& instead);

/// The window that a session is shown in.
/// @param name    of what plays; empty = none
/// @param height  of the character [m]
[[nodiscard]] Result<Window> openWindow(const std::string& name, double height);

/// Runs a session in a window of its own until that is closed or all is over.
/// @return success; or that it was interrupted, or what went wrong
[[nodiscard]] Result<void> runInOwnWindow(WindowSubject& subject, const PlaybackOptions& options);

/// A session without a window.
struct HeadlessRun {
  std::string doing;  ///< for the progress bar: "Playing"
  std::string name;   ///< of what plays
  std::string unit = "frames";
  int frames = 0;                      ///< at most
  std::function<void()> stepped = {};  ///< after each
};

/// Runs all frames, with the pictures that are wanted.
/// @return what was drawn; or that it was interrupted, or what went wrong
[[nodiscard]] Result<DrawnFiles> runHeadless(const HeadlessRun& run, const SnapshotOptions& pictures, Session& session);

}  // namespace lorica
