#include "apps/performance.h"

namespace lorica {

Result<Recording> makePerformance() {
  return readRecording("punch_and_kick");
}

}  // namespace lorica
