#pragma once

#include "apps/report.h"
#include "player/playback.h"
#include "prepare/body.h"
#include "prepare/cameras.h"
#include "prepare/playback_input.h"
#include "prepare/vmc_input.h"

#include <cstddef>
#include <functional>
#include <string>

namespace lorica {

/// The options of `lorica record FILE.lsession`.
struct SessionRecording {
  std::string out;
  PlaybackInputOptions input;  ///< no motion = a live camera
  DepthOptions depth;
  VmcInputOptions vmc;  ///< a program instead of a camera
  BodyOptions body;
  std::string scene;
  int people = 1;  ///< before the camera
  PlaybackOptions limit;
};

/// How many avatars the options ask for, as far as is known before anything is read.
[[nodiscard]] std::size_t avatarsOf(const SessionRecording& options);

/// Plays motions, or follows the people before a camera or programs that send, and records the session without a
/// window.
/// @param finished  called when the file is complete; may add to the report
[[nodiscard]] Result<void> recordSession(const SessionRecording& options, const CommonOptions& common,
                                         const std::function<Result<void>(Report&)>& finished = {});

}  // namespace lorica
