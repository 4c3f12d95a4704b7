#pragma once

#include "apps/body_choice.h"
#include "apps/depth_inputs.h"
#include "apps/playback_input.h"
#include "apps/report.h"
#include "apps/window_loop.h"

#include <string>

namespace lorica {

/// What `lorica record FILE.lsession` was asked for.
struct SessionRecording {
  std::string out;
  CastOptions cast;  ///< no motion = a live camera
  DepthOptions depth;
  BodyOptions body;
  std::string scene;
  PlaybackOptions limit;
};

/// Plays a motion, or follows whoever stands before a camera, and records the session; no window.
[[nodiscard]] Result<void> recordSession(const SessionRecording& options, const CommonOptions& common);

}  // namespace lorica
