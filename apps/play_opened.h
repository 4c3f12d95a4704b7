#pragma once

#include "apps/report.h"
#include "player/run.h"
#include "player/window_opener.h"

namespace lorica {

/// Continues on a screen with what the user opened there, as `lorica play --window` does, until it is closed. Its
/// report is that of what was played last.
[[nodiscard]] Result<void> playOpened(const CommonOptions& common, Host& host, Screen& screen, WindowOpener& opener,
                                      Cast opened);

}  // namespace lorica
