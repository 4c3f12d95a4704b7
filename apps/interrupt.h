#pragma once

namespace lorica {

/// From now on Ctrl-C asks for a clean stop instead of ending the program; a second Ctrl-C ends it at once.
void watchInterrupt();

/// Whether Ctrl-C was pressed since watchInterrupt().
[[nodiscard]] bool interrupted();

/// While one of these lives, there is nothing to clean up: whoever was asked to stop and does not within a second,
/// because one step takes so long, is ended then, with the words and exit status of a clean stop. One at a time.
class NothingToCleanUp {
 public:
  NothingToCleanUp();
  ~NothingToCleanUp();
  NothingToCleanUp(const NothingToCleanUp&) = delete;
  NothingToCleanUp& operator=(const NothingToCleanUp&) = delete;
};

/// Exit status of a program that Ctrl-C ended, as shells report it.
inline constexpr int kInterruptedStatus = 130;

}  // namespace lorica
