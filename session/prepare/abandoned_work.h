#pragma once

namespace lorica {

/// Whether work was given up that may still run in a thread.
[[nodiscard]] bool workAbandoned();
void noteAbandoned();
/// Ends the program without destroying what that thread may use.
[[noreturn]] void endWithoutIt(int status);

}  // namespace lorica
