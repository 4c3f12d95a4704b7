#pragma once

#include "apps/command_line.h"
#include "geometry/result.h"
#include "session/session.h"
#include "session/step_watcher.h"

#include <memory>
#include <string>
#include <vector>

namespace lorica {

/// Where a session's pose is sent.
struct VmcOutputOptions {
  std::string to;                  ///< HOST:PORT; empty = nowhere
  std::vector<std::string> bones;  ///< names of the bones to send; empty = all
};

/// --vmc-out HOST:PORT, --vmc-bones NAME,...
void addVmcOutputOptions(CommandLine& app, VmcOutputOptions& options);

/// Rejects a bad address or bone before any work.
[[nodiscard]] Result<void> checkVmcOutput(const VmcOutputOptions& options);

/// Sends a session's pose by the VMC protocol after each step, at most 60 times per second of its own time. A recording
/// is slowed down to real time. A receiver that is not there is no error.
/// @param next  another watcher of the same session; may be null
/// @return the watcher; `next` itself if nothing is to be sent; or an error: a bad address or bone, or the humanoid
/// bones that the character lacks
[[nodiscard]] Result<std::shared_ptr<StepWatcher>> makeVmcOutput(const VmcOutputOptions& options,
                                                                 const Character& character,
                                                                 std::shared_ptr<StepWatcher> next);

}  // namespace lorica
