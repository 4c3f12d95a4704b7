#pragma once

namespace lorica {

/// From now on Ctrl-C asks for a clean stop instead of ending the program; a second Ctrl-C ends it at once.
void watchInterrupt();

/// Whether Ctrl-C was pressed since watchInterrupt().
[[nodiscard]] bool interrupted();

}  // namespace lorica
