#pragma once

#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <string_view>
#include <utility>

namespace lorica {

/// Owns a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() { close(); }
  Descriptor(Descriptor&& other) noexcept : fd_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    reset(other.release());
    return *this;
  }
  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool valid() const { return fd_ >= 0; }
  void close() {
    if (valid()) ::close(fd_);
    fd_ = -1;
  }
  /// Leaves it to the caller.
  [[nodiscard]] int release() { return std::exchange(fd_, -1); }
  /// Owns another one instead.
  void reset(int fd) {
    close();
    fd_ = fd;
  }

 private:
  int fd_;
};

/// Writes everything, continuing after short writes and interruptions.
/// @param written  counts the bytes; null = not
/// @return 0, or errno
[[nodiscard]] inline int writeAll(int fd, std::string_view bytes, std::uint64_t* written = nullptr) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(fd, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    bytes.remove_prefix(count);
    if (written != nullptr) *written += count;
  }
  return 0;
}

}  // namespace lorica
