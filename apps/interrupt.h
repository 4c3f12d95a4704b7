#pragma once

namespace lorica {

/// After this call, Ctrl-C requests a clean stop instead of ending the program; a second Ctrl-C ends it immediately.
void watchInterrupt();

/// Whether Ctrl-C was pressed since watchInterrupt().
[[nodiscard]] bool interrupted();

/// While an object of this class exists, there is nothing to clean up: if the program does not stop within one second
/// of Ctrl-C, because a step takes long, it is ended with the message and exit status of a clean stop. One at a time.
class NothingToCleanUp {
 public:
  NothingToCleanUp();
  ~NothingToCleanUp();
  NothingToCleanUp(const NothingToCleanUp&) = delete;
  NothingToCleanUp& operator=(const NothingToCleanUp&) = delete;
};

/// Exit status of a program ended by Ctrl-C, as shells report it.
inline constexpr int kInterruptedStatus = 130;

}  // namespace lorica
