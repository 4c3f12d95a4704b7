#pragma once

// What reading and writing files asks of the system beyond std::filesystem. Windows has no devices, sockets, owners or
// modes among files that matter here, and no locks like flock(): the answers there are those for an ordinary file.

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#ifdef _WIN32
#include <io.h>
#include <process.h>
#else
#include <sys/file.h>
#endif

namespace lorica::system {

#ifdef _WIN32

using FileStatus = struct _stat64;
inline constexpr int kOwn = O_BINARY | O_NOINHERIT;
inline constexpr int kAtOnce = 0;

inline int openFile(const std::filesystem::path& file, int flags, int mode = 0) {
  return ::_wopen(file.c_str(), flags | kOwn, mode == 0 ? 0 : _S_IREAD | _S_IWRITE);
}
inline int statusOf(int descriptor, FileStatus& status) {
  return ::_fstat64(descriptor, &status);
}
inline int statusOf(const std::filesystem::path& file, FileStatus& status) {
  return ::_wstat64(file.c_str(), &status);
}
inline bool isSocket(const FileStatus&) {
  return false;
}
inline bool isDevice(const FileStatus& status) {
  return S_ISCHR(status.st_mode);
}
inline bool isOwn(const FileStatus&) {
  return true;
}
inline bool isForAllToWrite(const FileStatus&) {
  return false;
}
inline bool keepsFilesOfOthers(const FileStatus&) {
  return true;
}
inline int makeFolder(const std::filesystem::path& folder) {
  return ::_wmkdir(folder.c_str());
}
inline int removeFile(const std::filesystem::path& file) {
  return ::_wunlink(file.c_str());
}
inline int takeMode(int, const FileStatus&) {
  return 0;
}
inline int flush(int descriptor) {
  return ::_commit(descriptor);
}
inline int processNumber() {
  return ::_getpid();
}
inline bool lock(int) {
  return true;
}

#else

using FileStatus = struct stat;
inline constexpr int kAtOnce = O_NONBLOCK | O_NOCTTY;  ///< does not wait until somebody writes into a named pipe

/// As open(); programs that are started do not inherit it. @return a descriptor, or -1 and errno, as all below that
/// return a number; those return 0
inline int openFile(const std::filesystem::path& file, int flags, mode_t mode = 0) {
  return ::open(file.c_str(), flags | O_CLOEXEC, mode);
}
inline int statusOf(int descriptor, FileStatus& status) {
  return ::fstat(descriptor, &status);
}
inline int statusOf(const std::filesystem::path& file, FileStatus& status) {
  return ::stat(file.c_str(), &status);
}
inline bool isSocket(const FileStatus& status) {
  return S_ISSOCK(status.st_mode);
}
inline bool isDevice(const FileStatus& status) {
  return S_ISCHR(status.st_mode) || S_ISBLK(status.st_mode);
}
inline bool isOwn(const FileStatus& status) {
  return status.st_uid == ::geteuid();
}
inline bool isForAllToWrite(const FileStatus& status) {
  return (status.st_mode & S_IWOTH) != 0;
}
/// Of a folder: whether nobody can rename what others have in it.
inline bool keepsFilesOfOthers(const FileStatus& status) {
  return !isForAllToWrite(status) || (status.st_mode & S_ISVTX) != 0;
}
inline int makeFolder(const std::filesystem::path& folder) {
  return ::mkdir(folder.c_str(), S_IRWXU);
}
inline int removeFile(const std::filesystem::path& file) {
  return ::unlink(file.c_str());
}
inline int takeMode(int descriptor, const FileStatus& status) {
  return ::fchmod(descriptor, status.st_mode & 07777);
}
inline int flush(int descriptor) {
  return ::fsync(descriptor);
}
inline int processNumber() {
  return ::getpid();
}
/// @return false if another program has locked it; some file systems have no locks
inline bool lock(int descriptor) {
  return ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

#endif

inline bool isLink(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::is_symlink(file, error);
}

}  // namespace lorica::system
