#pragma once

#include <sys/types.h>

#include <filesystem>

namespace lorica::test {

/// A shell script that runs in parallel with the test, in its own folder. When this object ends, the script and what it
/// started are killed: a display that is opened later may have the same number, and must not get its keys.
class BackgroundScript {
 public:
  /// `seconds`: how long the script may run before it gets SIGTERM. `log` receives its output.
  BackgroundScript(const std::filesystem::path& script, int seconds, const std::filesystem::path& log = "/dev/null");
  /// Ends the script, but not one that is at its end: a key whose press was sent and whose release was not repeats
  /// itself in the next window.
  ~BackgroundScript();
  BackgroundScript(const BackgroundScript&) = delete;
  BackgroundScript& operator=(const BackgroundScript&) = delete;

 private:
  pid_t group_ = -1;
};

}  // namespace lorica::test
