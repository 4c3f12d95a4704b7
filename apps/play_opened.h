#pragma once

#include "apps/command_line.h"
#include "apps/report.h"
#include "player/window_opener.h"
#include "viewer/window/window.h"

namespace lorica {

/// Goes on in a window with what the user opened there, as `lorica play --window` does, until it is closed. Its report
/// is that of what was played last.
[[nodiscard]] Result<void> playOpened(const CommonOptions& common, Window& window, WindowOpener& opener,
                                      LoadedCast opened);

}  // namespace lorica
