#include "bake/file_layer.h"

#include "geometry/descriptor.h"
#include "geometry/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

namespace lorica {
namespace {

/// Writes everything and closes the file: some file systems report a full disk only then. @return 0, or errno
int writeAndClose(int fd, std::string_view content) {
  int error = writeAll(fd, content);
  if (error == 0 && ::fsync(fd) != 0) error = errno;
  if (::close(fd) != 0 && error == 0) error = errno;
  return error;
}

}  // namespace

Result<std::string> FileLayer::read(const std::filesystem::path& file) {
  return readFile(file, NamedBy::kFile);
}

bool FileLayer::exists(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::exists(file, ignored);
}

int FileLayer::create(const std::filesystem::path& file, std::string_view content) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd < 0) return errno;
  const int error = writeAndClose(fd, content);
  if (error != 0) ::unlink(file.c_str());
  return error;
}

int FileLayer::overwrite(const std::filesystem::path& file, std::string_view content) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
  return fd < 0 ? errno : writeAndClose(fd, content);
}

int FileLayer::rename(const std::filesystem::path& from, const std::filesystem::path& to) {
  return std::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

int FileLayer::createFolders(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  return error.value();
}

int FileLayer::link(const std::filesystem::path& target, const std::filesystem::path& link) {
  std::error_code error;
  const std::filesystem::file_status there = std::filesystem::symlink_status(link, error);
  if (std::filesystem::exists(there) && !std::filesystem::is_symlink(there)) return EEXIST;
  std::filesystem::path made = link;
  made += ".new";
  ::unlink(made.c_str());
  if (::symlink(target.c_str(), made.c_str()) != 0) return errno;
  return rename(made, link);
}

void FileLayer::removeEmpty(const std::filesystem::path& folder) {
  ::rmdir(folder.c_str());
}

int FileLayer::remove(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::remove_all(path, error);
  return error.value();
}

}  // namespace lorica
