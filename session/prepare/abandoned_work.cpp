#include "session/prepare/abandoned_work.h"

#include "geometry/hard_stop.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace lorica {
namespace {

std::atomic<bool> gAbandoned = false;

}  // namespace

bool workAbandoned() {
  return gAbandoned;
}

void noteAbandoned() {
  gAbandoned = true;
}

void endWithoutIt(int status) {
  runHardStop();
  std::fflush(nullptr);
  std::_Exit(status);
}

}  // namespace lorica
