#include "geometry/descriptor.h"
#include "geometry/sanitizer.h"
#include "skinning/import/isolated_protocol.h"
#include "skinning/import/isolated_reader.h"
#include "skinning/import/isolated_scene.h"

#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <new>
#include <span>
#include <string>

namespace lorica {

namespace {

constexpr int kFailed = 1;

void limit(__rlimit_resource resource, std::uint64_t value) {
  struct rlimit limits {};
  if (::getrlimit(resource, &limits) != 0) return;
  limits.rlim_cur = std::min<rlim_t>(value, limits.rlim_max);
  (void)::setrlimit(resource, &limits);
}

/// Bytes of addresses that this process has now.
std::uint64_t addressBytes() {
  unsigned long long pages = 0;
  std::FILE* file = std::fopen("/proc/self/statm", "re");
  if (file == nullptr) return 0;
  if (std::fscanf(file, "%llu", &pages) != 1) pages = 0;
  std::fclose(file);
  return pages * ::sysconf(_SC_PAGESIZE);
}

void setLimits(std::uint64_t fileBytes) {
  const IsolationLimits limits = isolationLimits(fileBytes);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::prctl(PR_SET_DUMPABLE, 0);  // a crash is expected, and no matter for whatever collects crashes
  (void)::signal(SIGXCPU, SIG_DFL);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_STACK, limits.stackBytes);
  limit(RLIMIT_CPU, limits.cpuSeconds);
  if (!kReservesAddresses) limit(RLIMIT_AS, addressBytes() + limits.memoryBytes);
  std::set_new_handler([] { ::_exit(isolated::kOutOfMemory); });
}

bool readAll(std::string& bytes) {
  const off_t size = ::lseek(STDIN_FILENO, 0, SEEK_END);
  if (size < 0 || ::lseek(STDIN_FILENO, 0, SEEK_SET) != 0) return false;
  bytes.resize(size);
  std::size_t length = 0;
  while (length < bytes.size()) {
    const ssize_t got = ::read(STDIN_FILENO, bytes.data() + length, bytes.size() - length);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    length += got;
  }
  return true;
}

}  // namespace

int serveIsolatedReader() {
  ::close_range(STDERR_FILENO + 1, ~0U, 0);
  std::string bytes;
  if (!readAll(bytes)) return kFailed;
  setLimits(bytes.size());
  std::string_view question = bytes;
  const Result<isolated::Head> head = isolated::decodeHead(question);
  if (!head) return kFailed;
  const Result<FileScene> scene =
      readAssimpScene(std::as_bytes(std::span(question)), head->name, head->format, head->files);
  return writeAll(STDOUT_FILENO, isolated::encodeAnswer(scene)) == 0 ? 0 : kFailed;
}

}  // namespace lorica
