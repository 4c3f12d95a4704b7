#include "apps/interrupt.h"

#include "apps/report.h"
#include "geometry/hard_stop.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <thread>

namespace lorica {
namespace {

constexpr int kGraceMs = 400;
constexpr std::chrono::seconds kFinishing{5};  // for recordings that are finished; a file server may hang

volatile std::sig_atomic_t gSignal = 0;
volatile std::sig_atomic_t gSignals = 0;
std::atomic<bool> gAnswered = false;
std::atomic<bool> gSaid = false;
std::array<int, 2> gPipe = {-1, -1};  // from the handler to the watcher: a byte for each signal

// Must be async-signal-safe: no allocation, no streams, no locks.
void onSignal(int number) {
  if (gSignals >= 2) _exit(128 + number);
  gSignal = number;
  gSignals = gSignals + 1;
  [[maybe_unused]] const ssize_t written = write(gPipe[1], "!", 1);
}

/// Waits for a signal. @param ms  -1 = for ever  @return false if none came
bool waitForSignal(int ms) {
  pollfd waiting = {gPipe[0], POLLIN, 0};
  if (poll(&waiting, 1, ms) <= 0) return false;
  char byte = 0;
  return read(gPipe[0], &byte, 1) == 1;
}

void watch() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);  // other threads run the handler
  while (!waitForSignal(-1)) {
  }
  if (!waitForSignal(kGraceMs) && gAnswered) {
    while (!waitForSignal(-1)) {
    }
  }
  std::thread([] {
    std::this_thread::sleep_for(kFinishing);
    _exit(interruptedStatus());
  }).detach();
  runHardStop();
  sayCancelled();
  _exit(interruptedStatus());
}

}  // namespace

void watchInterrupt() {
  if (pipe2(gPipe.data(), O_CLOEXEC) != 0) return;  // the signals end the program as usual
  std::thread(watch).detach();
  struct sigaction action = {};
  action.sa_flags = SA_RESTART;  // a blocked write continues, so that output stays complete
  sigemptyset(&action.sa_mask);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before = {};
    sigaction(number, nullptr, &before);
    action.sa_handler = onSignal;
    if (before.sa_handler != SIG_IGN) sigaction(number, &action, nullptr);
  }
  action.sa_handler = SIG_IGN;
  for (const int number : {SIGPIPE, SIGXFSZ}) sigaction(number, &action, nullptr);  // writing fails instead
}

bool interrupted() {
  return gSignal != 0;
}

void answerInterrupt() {
  gAnswered = true;
}

void sayCancelled() {
  if (gSaid.exchange(true)) return;
  pollfd error = {STDERR_FILENO, POLLOUT, 0};
  if (poll(&error, 1, 0) == 0) return;  // a full pipe that nobody reads
  // Overwrite a progress bar on the current line.
  say(isatty(STDERR_FILENO) == 1 ? "\r\x1b[Klorica: cancelled\n" : "lorica: cancelled\n");
}

int interruptedStatus() {
  return 128 + (gSignal != 0 ? gSignal : SIGINT);
}

}  // namespace lorica
