#pragma once

#include "collision/world/world.h"
#include "viewer/scene.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// A stage of a frame and how long it took.
struct TimedStage {
  const char* name = "";  ///< of static storage
  double milliseconds = 0.0;
};

/// What the panels of a window show, borrowed while they are drawn. Knows nothing of sessions or files.
struct WindowValues {
  std::string_view name;                  ///< of what plays
  std::string_view status;                ///< a line on what goes on
  double seconds = 0.0;                   ///< since the first frame [s]
  double duration = 0.0;                  ///< of a recording [s]; 0 = live, without a timeline or a speed
  bool ended = false;                     ///< there are no more frames
  int parts = 0;                          ///< of the body
  int mostParts = 0;                      ///< at the finest level of detail; 0 = not to be chosen
  bool preparingParts = false;            ///< another level is being made
  std::span<const std::string> scenes;    ///< to choose from; empty = none
  int scene = 0;                          ///< which of them it is
  std::span<const std::string> warnings;  ///< sentences
  bool holdsProp = false;                 ///< the mouse moves a prop and not the camera
};

/// What a person asked for at a window since it was last asked; what only the window needs to know it keeps.
struct WindowRequests {
  std::optional<double> seekTo;  ///< this time of the recording [s]
  std::optional<int> parts;      ///< another level of detail
  std::optional<int> scene;      ///< another of WindowValues::scenes
  bool throwBall = false;
  std::optional<Ray> pressed;  ///< the left button went down where no panel is
  bool released = false;       ///< and came up
};

}  // namespace lorica
