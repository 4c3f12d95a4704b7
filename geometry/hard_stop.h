#pragma once

#include <cstdint>
#include <functional>

namespace lorica {

/// Something that has to be done if the program is ended from outside while this object exists: a temporary file to
/// remove, a recording to finish. Nothing happens unless somebody calls runHardStop(), as the `lorica` command does on
/// SIGINT, SIGTERM and SIGHUP.
class AtHardStop {
 public:
  /// @param task  runs in another thread, while the work that it ends may still be going on
  explicit AtHardStop(std::function<void()> task);
  /// The task does not run any more. Never returns once runHardStop() was called: the program is ending.
  ~AtHardStop();
  AtHardStop(const AtHardStop&) = delete;
  AtHardStop& operator=(const AtHardStop&) = delete;

 private:
  std::uint64_t number_;
};

/// Runs the tasks, the newest first. The caller must end the program without destructors (_exit) right afterwards.
void runHardStop();

}  // namespace lorica
