#include "apps/interrupt.h"

#include <csignal>

namespace lorica {
namespace {

volatile std::sig_atomic_t gInterrupted = 0;

void onInterrupt(int) {
  gInterrupted = 1;
}

}  // namespace

void watchInterrupt() {
  struct sigaction action = {};
  action.sa_handler = onInterrupt;
  // The second Ctrl-C meets the default handler; a blocked write is restarted, so that no output is torn.
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
}

bool interrupted() {
  return gInterrupted != 0;
}

}  // namespace lorica
