#include "geometry/part_file.h"

#include "geometry/errors.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace lorica {
namespace {

namespace fs = std::filesystem;

}  // namespace

Result<std::optional<fs::path>> keepFound(const fs::path& part) {
  using Found = std::optional<fs::path>;
  const int found = ::open(part.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (found < 0 && errno == ENOENT) return Found();
  if (found < 0) return unwritable(part, errno);
  const bool isWritten = ::flock(found, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(found);
  if (isWritten) {
    return unwritable("{}: another program is writing to it", part.string());
  }
  const fs::path name = part.stem().replace_extension();
  for (int number = 1;; ++number) {
    const fs::path kept =
        part.parent_path() / fmt::format("{}.found-{}{}", name.string(), number, part.extension().string());
    std::error_code error;
    if (fs::exists(fs::symlink_status(kept, error))) continue;
    fs::rename(part, kept, error);
    if (error) return unwritable(part, error.value());
    return Found(kept);
  }
}

Result<int> createPart(const fs::path& part) {
  const int descriptor = ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor < 0) return unwritable(part, errno);
  (void)::flock(descriptor, LOCK_EX | LOCK_NB);  // some file systems have no locks
  return descriptor;
}

}  // namespace lorica
