#pragma once

/// Internal: not installed.

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>

namespace lorica {

/// Goes back to the working folder, however the block is left: OpenNI2 changes it while it looks for drivers, and NiTE
/// 2 wants to start in its own.
class WorkingFolder {
 public:
  WorkingFolder() : descriptor_(::open(".", O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {}
  ~WorkingFolder() {
    if (descriptor_ < 0) return;
    if (::fchdir(descriptor_) != 0) std::fprintf(stderr, "lorica: the working folder was lost\n");
    ::close(descriptor_);
  }
  WorkingFolder(const WorkingFolder&) = delete;
  WorkingFolder& operator=(const WorkingFolder&) = delete;

 private:
  int descriptor_;
};

}  // namespace lorica
