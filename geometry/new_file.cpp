#include "geometry/new_file.h"

#include "geometry/descriptor.h"
#include "geometry/errors.h"
#include "geometry/system_files.h"

#include <fmt/format.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

/// Opens a new file in the target's folder, so that the rename stays on one file system. O_EXCL ensures that two
/// writers never share a file.
int openBeside(const fs::path& target, int mode, fs::path& temporary) {
  static std::atomic<unsigned> counter{0};
  for (int attempt = 0; attempt < 100; ++attempt) {
    temporary = target;
    temporary += fmt::format(".tmp-{}-{}", system::processNumber(), counter.fetch_add(1));
    const int fd = system::openFile(temporary, O_WRONLY | O_CREAT | O_EXCL, mode);
    if (fd >= 0 || errno != EEXIST) return fd;
  }
  return -1;
}

}  // namespace

NewFile::NewFile(fs::path file, fs::path target) : file_(std::move(file)), target_(std::move(target)) {}

NewFile::~NewFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) system::removeFile(temporary_);
}

Error NewFile::failed(int error) {
  return unwritable(file_, error);
}

Result<std::unique_ptr<NewFile>> NewFile::create(const fs::path& file, NamedBy by) {
  // Keep symbolic links of the user: replace the file that they point to. Never replace a device or folder by a file.
  std::error_code ignored;
  fs::path target = file;
  if (by == NamedBy::kUser && fs::is_symlink(file, ignored)) {
    const fs::path resolved = fs::weakly_canonical(file, ignored);
    if (!ignored) target = resolved;
  }
  system::FileStatus status{};
  const bool exists = !system::isLink(target) && system::statusOf(target, status) == 0;
  if (exists && S_ISDIR(status.st_mode)) return unwritable(file, EISDIR);
  if (exists && !S_ISREG(status.st_mode)) return unwritable("{}: cannot be written: not a regular file", file.string());

  std::unique_ptr<NewFile> made(new NewFile(file, target));
  fs::path temporary;
  made->descriptor_ = openBeside(target, by == NamedBy::kSecret ? 0600 : 0666, temporary);
  if (made->descriptor_ < 0) return made->failed(errno);
  made->temporary_ = temporary;
  made->cleaning_ = std::make_unique<AtHardStop>([temporary] { system::removeFile(temporary); });
  if (exists && by != NamedBy::kSecret && system::takeMode(made->descriptor_, status) != 0) return made->failed(errno);
  return made;
}

Result<void> NewFile::write(std::string_view piece) {
  if (const int error = writeAll(descriptor_, piece); error != 0) return failed(error);
  return {};
}

Result<void> NewFile::finish() {
  int error = system::flush(descriptor_) != 0 ? errno : 0;
  // Some file systems report a full disk only here.
  if (::close(std::exchange(descriptor_, -1)) != 0 && error == 0) error = errno;
  std::error_code renamed;
  if (error == 0) fs::rename(temporary_, target_, renamed);
  if (error == 0) error = renamed.value();
  if (error != 0) return failed(error);
  temporary_.clear();
  cleaning_.reset();
  return {};
}

Result<std::optional<fs::path>> keepFound(const fs::path& part) {
  using Found = std::optional<fs::path>;
  const int found = system::openFile(part, O_RDONLY | system::kAtOnce);
  if (found < 0 && errno == ENOENT) return Found();
  if (found < 0) return unwritable(part, errno);
  const bool isWritten = !system::lock(found);
  ::close(found);
  if (isWritten) return unwritable("{}: another program is writing to it", part.string());
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
  const int descriptor = system::openFile(part, O_WRONLY | O_CREAT | O_EXCL | O_APPEND, 0666);
  if (descriptor < 0) return unwritable(part, errno);
  (void)system::lock(descriptor);
  return descriptor;
}

}  // namespace lorica
