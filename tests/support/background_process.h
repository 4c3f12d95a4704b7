#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>

namespace lorica::test {

/// Work that a process of its own does in parallel with the test. When this object ends, that process and what it
/// started are killed: a display that is opened later may have the same number, and must not get its keys.
class BackgroundProcess {
 public:
  /// @param log  receives the output
  explicit BackgroundProcess(const std::function<void()>& work, const std::filesystem::path& log = "/dev/null");
  ~BackgroundProcess();
  BackgroundProcess(const BackgroundProcess&) = delete;
  BackgroundProcess& operator=(const BackgroundProcess&) = delete;

 private:
  pid_t group_ = -1;
};

}  // namespace lorica::test
