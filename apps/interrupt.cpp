#include "apps/interrupt.h"

#include <unistd.h>
#include <csignal>
#include <string_view>

namespace lorica {
namespace {

constexpr unsigned kGraceSeconds = 1;

volatile std::sig_atomic_t gInterrupted = 0;
volatile std::sig_atomic_t gNothingToCleanUp = 0;
volatile std::sig_atomic_t gTerminal = 0;

// Both handlers must be async-signal-safe: no allocation, no streams.
void onInterrupt(int) {
  gInterrupted = 1;
  if (gNothingToCleanUp != 0) alarm(kGraceSeconds);
}

void onGraceOver(int) {
  if (gNothingToCleanUp == 0) return;
  // Overwrite a progress bar on the current line.
  const std::string_view words = gTerminal != 0 ? "\r\x1b[Klorica: cancelled\n" : "lorica: cancelled\n";
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, words.data(), words.size());
  _exit(kInterruptedStatus);
}

}  // namespace

void watchInterrupt() {
  struct sigaction action = {};
  action.sa_handler = onInterrupt;
  // The second Ctrl-C reaches the default handler; a blocked write is restarted, so that output stays complete.
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  action.sa_handler = onGraceOver;
  action.sa_flags = SA_RESTART;
  sigaction(SIGALRM, &action, nullptr);
}

bool interrupted() {
  return gInterrupted != 0;
}

NothingToCleanUp::NothingToCleanUp() {
  gTerminal = isatty(STDERR_FILENO);
  gNothingToCleanUp = 1;
  if (interrupted()) alarm(kGraceSeconds);  // Ctrl-C was pressed just before
}

NothingToCleanUp::~NothingToCleanUp() {
  gNothingToCleanUp = 0;
  alarm(0);
}

}  // namespace lorica
