// A library that is loaded before a command (LD_PRELOAD) and stands for what the machine does to it.
// LORICA_SHIM=away: the file server of the folder LORICA_SHIM_FOLDER is gone: whatever is written there fails.
// LORICA_SHIM=hangs: it does not answer: whatever is written there waits for ever.
// LORICA_SHIM=clock: the clock of the machine says 1970 and runs backwards, an hour each time that it is asked.
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace {

bool mode(const char* name) {
  const char* set = std::getenv("LORICA_SHIM");
  return set != nullptr && std::strcmp(set, name) == 0;
}

bool isInFolder(const char* path) {
  const char* folder = std::getenv("LORICA_SHIM_FOLDER");
  return folder != nullptr && path != nullptr && std::strncmp(path, folder, std::strlen(folder)) == 0;
}

/// Whether the server of what is written to is away; waits for it if it hangs.
bool isAway(int descriptor) {
  const bool hangs = mode("hangs");
  if (!hangs && !mode("away")) return false;
  char link[40], path[4096];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length <= 0) return false;
  path[length] = '\0';
  if (!isInFolder(path)) return false;
  while (hangs) pause();
  errno = ESTALE;
  return true;
}

template <typename Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

std::atomic<long> gAsked = 0;
thread_local time_t tAnswered = 0;  // to the thread's last question

/// @return whether the time was written
bool wrongTime(time_t& seconds) {
  if (!mode("clock")) return false;
  seconds = tAnswered = 86400L * 30 - 3600 * ++gAsked;
  return true;
}

/// When a wait until a wrong time ends. The kernel's clock stays right, so that OpenNI2 would not wait for its threads
/// at all and cancel them.
timespec rightTime(timespec until) {
  const time_t left = until.tv_sec - tAnswered;
  if (!mode("clock") || left < 0 || left > 600) return until;  // or of another clock
  timespec right{};
  next<int (*)(clockid_t, timespec*)>("clock_gettime")(CLOCK_REALTIME, &right);
  right.tv_sec += left + (right.tv_nsec + until.tv_nsec) / 1'000'000'000;
  right.tv_nsec = (right.tv_nsec + until.tv_nsec) % 1'000'000'000;
  return right;
}

}  // namespace

extern "C" {

ssize_t write(int descriptor, const void* bytes, size_t count) {
  if (isAway(descriptor)) return -1;
  return next<ssize_t (*)(int, const void*, size_t)>("write")(descriptor, bytes, count);
}

ssize_t writev(int descriptor, const iovec* parts, int count) {
  if (isAway(descriptor)) return -1;
  return next<ssize_t (*)(int, const iovec*, int)>("writev")(descriptor, parts, count);
}

int fsync(int descriptor) {
  if (isAway(descriptor)) return -1;
  return next<int (*)(int)>("fsync")(descriptor);
}

int clock_gettime(clockid_t clock, timespec* time) {
  if (clock == CLOCK_REALTIME && wrongTime(time->tv_sec)) {
    time->tv_nsec = 0;
    return 0;
  }
  return next<int (*)(clockid_t, timespec*)>("clock_gettime")(clock, time);
}

int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex, const timespec* until) {
  const timespec right = rightTime(*until);
  using Wait = int (*)(pthread_cond_t*, pthread_mutex_t*, const timespec*);
  return next<Wait>("pthread_cond_timedwait")(condition, mutex, &right);
}

int pthread_timedjoin_np(pthread_t thread, void** result, const timespec* until) {
  const timespec right = rightTime(*until);
  return next<int (*)(pthread_t, void**, const timespec*)>("pthread_timedjoin_np")(thread, result, &right);
}

time_t time(time_t* result) {
  time_t seconds = 0;
  if (!wrongTime(seconds)) return next<time_t (*)(time_t*)>("time")(result);
  if (result != nullptr) *result = seconds;
  return seconds;
}

}  // extern "C"
