#pragma once

#include "apps/report.h"
#include "prepare/live_cast.h"

#include <cstddef>
#include <functional>
#include <string>

namespace lorica {

/// The options of `lorica record FILE.lsession`.
struct SessionRecording {
  std::string out;
  CastRequest request;  ///< no motion = a live camera
  LiveRequest live;
  int frames = 0;        ///< maximum; 0 = no limit
  double seconds = 0.0;  ///< maximum [s]; 0 = no limit
};

/// How many avatars the options ask for, as far as is known before anything is read.
[[nodiscard]] std::size_t avatarsOf(const SessionRecording& options);

/// Plays motions, or follows the people before a camera or programs that send, and records the session without a
/// window.
/// @param finished  called when the file is complete; may add to the report
[[nodiscard]] Result<void> recordSession(const SessionRecording& options, const CommonOptions& common, Host& host,
                                         const std::function<Result<void>(Report&)>& finished = {});

}  // namespace lorica
