#pragma once

#include "player/playback.h"
#include "player/snapshots.h"
#include "player/window_loop.h"

#include <functional>
#include <string>

namespace lorica {

/// Rejects --window if there is no display.
/// @param instead  alternatives, for the error message
[[nodiscard]] Result<void> checkWindow(bool wanted, const std::string& instead);

/// Opens a window before there is a session.
[[nodiscard]] Result<Window> openWindow();
/// Prepares a window for a session: its title, its camera and what is drawn.
/// @param name  of the motion; empty = none
/// @param avatars  how many of them the first picture should hold
void prepareWindow(const std::string& name, const Character& character, std::size_t avatars, Window& window);

/// A session without a window.
struct HeadlessRun {
  std::string doing;  ///< label of the progress bar: "Playing"
  std::string name;   ///< of the motion
  std::string unit = "frames";
  int frames = 0;                             ///< maximum
  int expected = 0;                           ///< for the progress bar; 0 = the maximum
  std::function<void()> stepped = {};         ///< called after each frame
  std::function<std::string()> caption = {};  ///< what pictures say after the name; null = nothing
};

/// Runs all frames and draws the requested pictures.
/// @return the written files, kCancelled, or another error
[[nodiscard]] Result<DrawnFiles> runHeadless(const HeadlessRun& run, const SnapshotOptions& pictures, Session& session);

}  // namespace lorica
