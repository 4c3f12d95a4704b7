#include "skinning/import/isolated_scene.h"

#include "geometry/byte_reader.h"
#include "geometry/descriptor.h"
#include "geometry/errors.h"
#include "geometry/sanitizer.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <new>
#include <system_error>

extern char** environ;

namespace lorica {

namespace {

using Clock = std::chrono::steady_clock;

/// A running process, which is ended and waited for at the latest when this goes out of scope.
class Child {
 public:
  explicit Child(pid_t pid) : pid_(pid) {}
  ~Child() { (void)end(); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  /// Ends the process if it still runs. @return its status, as waitpid() gives it
  [[nodiscard]] int end() {
    if (pid_ > 0) ::kill(pid_, SIGKILL);
    return wait();
  }
  /// Waits for its end. @return its status
  [[nodiscard]] int wait() {
    while (pid_ > 0 && ::waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status_;
  }

 private:
  pid_t pid_;
  int status_ = 0;
};

/// Starts the program with these files as standard input and output, and nothing as standard error, in a process group
/// of its own, so that Ctrl-C reaches this process alone. @return 0, or errno
int start(const IsolatedReader& reader, int in, int out, pid_t& pid) {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawnattr_init(&attributes);
  ::posix_spawn_file_actions_adddup2(&files, in, STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&files, out, STDOUT_FILENO);
  ::posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  sigset_t none;
  sigset_t all;
  sigemptyset(&none);
  sigfillset(&all);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setsigdefault(&attributes, &all);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  std::vector<std::string> words = {reader.program.string()};
  words.insert(words.end(), reader.arguments.begin(), reader.arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const int error = ::posix_spawn(&pid, reader.program.c_str(), &files, &attributes, pointers.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&files);
  return error;
}

/// What ended the process, as the end of a sentence.
std::string causeOf(int status, const IsolationLimits& limits) {
  if (WIFEXITED(status)) {
    if (WEXITSTATUS(status) == isolated::kOutOfMemory) {
      return fmt::format("reading it takes more than {} MB of memory", limits.memoryBytes / 1'000'000);
    }
    return fmt::format("its reader failed (exit status {})", WEXITSTATUS(status));
  }
  const int signal = WTERMSIG(status);
  if (signal == SIGXCPU) return fmt::format("reading it takes longer than {} s", limits.cpuSeconds);
  if (signal == SIGKILL) return "its reader was killed";
  return fmt::format("its reader crashed ({}), as by nodes that contain each other or nest too deeply",
                     signal == SIGSEGV   ? "SIGSEGV"
                     : signal == SIGABRT ? "SIGABRT"
                                         : fmt::format("signal {}", signal));
}

/// The end of what a process says, or of its patience.
enum class Heard { kAll, kTooMuch, kTooLate, kCancelled };

/// Reads until the other end is closed.
Heard hear(int fd, const IsolationLimits& limits, const std::function<bool()>& cancelled, std::string& heard) {
  // A process that waits, for a slow disk say, uses no time of its own.
  const Clock::time_point last = Clock::now() + std::chrono::seconds(30 + 10 * limits.cpuSeconds);
  std::array<char, 65536> buffer;
  while (true) {
    if (cancelled && cancelled()) return Heard::kCancelled;
    if (Clock::now() > last) return Heard::kTooLate;
    pollfd ready = {fd, POLLIN, 0};
    constexpr int kPatienceMs = 20;
    if (::poll(&ready, 1, kPatienceMs) <= 0) continue;
    const ssize_t got = ::read(fd, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return Heard::kAll;
    if (heard.size() + got > limits.memoryBytes) return Heard::kTooMuch;
    heard.append(buffer.data(), got);
  }
}

Error unstartable(const std::string& name, const IsolatedReader& reader, int error) {
  return unreadable("{}: cannot be read: its reader {} could not be started: {}", name, reader.program.string(),
                    std::generic_category().message(error));
}

}  // namespace

IsolationLimits isolationLimits(std::uint64_t fileBytes) {
  constexpr std::uint64_t kMegabyte = 1'000'000;
  IsolationLimits limits;
  limits.cpuSeconds = 1 + fileBytes / kMegabyte;
  limits.memoryBytes = 300 * kMegabyte + 100 * fileBytes;
  limits.stackBytes = std::uint64_t{8} << 20;
  return limits;
}

Result<FileScene> readIsolatedScene(std::span<const std::byte> bytes, const std::string& name, AssimpFormat format,
                                    const NamedFiles& files, const IsolatedReader& reader) {
  // 1. The question, in memory: a pipe could fill up while the other side writes its answer.
  const Descriptor question(::memfd_create("lorica-question", MFD_CLOEXEC));
  int error = question.get() < 0 ? errno : writeAll(question.get(), isolated::encodeHead(format, name, files));
  if (error == 0) error = writeAll(question.get(), {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (error == 0 && ::lseek(question.get(), 0, SEEK_SET) != 0) error = errno;
  std::array<int, 2> ends = {-1, -1};
  if (error == 0 && ::pipe2(ends.data(), O_CLOEXEC) != 0) error = errno;
  const Descriptor in(ends[0]);
  Descriptor out(ends[1]);
  if (error != 0) return unstartable(name, reader, error);

  // 2. The other process.
  pid_t pid = -1;
  error = start(reader, question.get(), out.get(), pid);
  if (error != 0) return unstartable(name, reader, error);
  Child child(pid);
  out.close();
  const IsolationLimits limits = isolationLimits(bytes.size());
  std::string answer;
  const Heard heard = hear(in.get(), limits, reader.cancelled, answer);
  if (heard == Heard::kCancelled) return cancelled();
  const int status = heard == Heard::kAll ? child.wait() : child.end();

  // 3. Its answer, which is believed only after a check.
  const char* formatName = format == AssimpFormat::kFbx ? "FBX" : "COLLADA";
  const auto broken = [&](const std::string& why) { return badFormat("{}: broken {}: {}", name, formatName, why); };
  if (heard == Heard::kTooMuch) {
    return broken(fmt::format("its content takes more than {} MB", limits.memoryBytes / 1'000'000));
  }
  if (heard == Heard::kTooLate) return broken("its reader does not end");
  if (status != 0) return broken(causeOf(status, limits));
  return isolated::decodeAnswer(answer, name);
}

// The other side.

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
