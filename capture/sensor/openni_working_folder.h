#pragma once

/// Internal: not installed.

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>

namespace lorica {

/// Restores the working folder at the end of the block, however it is left: OpenNI2 changes it while it looks for
/// drivers, and NiTE 2 must be started in its own folder.
class WorkingFolder {
 public:
  WorkingFolder() : descriptor_(::open(".", O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {}
  ~WorkingFolder() {
    if (descriptor_ < 0) return;
    if (::fchdir(descriptor_) != 0) std::fprintf(stderr, "lorica: the working folder could not be restored\n");
    ::close(descriptor_);
  }
  WorkingFolder(const WorkingFolder&) = delete;
  WorkingFolder& operator=(const WorkingFolder&) = delete;

 private:
  int descriptor_;
};

}  // namespace lorica
