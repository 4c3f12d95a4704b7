#pragma once

#include "apps/body_choice.h"
#include "apps/depth_inputs.h"
#include "apps/playback_input.h"
#include "apps/report.h"
#include "apps/window_loop.h"

#include <string>

namespace lorica {

/// The options of `lorica record FILE.lsession`.
struct SessionRecording {
  std::string out;
  PlaybackInputOptions input;  ///< no motion = a live camera
  DepthOptions depth;
  BodyOptions body;
  std::string scene;
  PlaybackOptions limit;
};

/// Plays a motion, or follows the person before a camera, and records the session without a window.
[[nodiscard]] Result<void> recordSession(const SessionRecording& options, const CommonOptions& common);

}  // namespace lorica
