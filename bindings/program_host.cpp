#include "bindings/program_host.h"

#include "geometry/errors.h"
#include "geometry/work_budgets.h"

#include <utility>

namespace lorica {
Result<void> checkCounts(int parts, const HullBudget& budget, int threads) {
  const auto fits = [](int count, int min, int max) { return count == 0 || (count >= min && count <= max); };
  if (!fits(threads, 1, kMaxThreads)) {
    return invalidArgument("threads: found {}, expected 1 to {}, or 0 for all of the machine's", threads, kMaxThreads);
  }
  for (const auto& [what, limit] : {std::pair{"vertices", budget.vertices}, {"planes", budget.planes}}) {
    if (!fits(limit, 4, kMaxOfAnything)) {
      return invalidArgument("{} of a hull: found {}, expected at least 4 and at most {}, or 0 for no limit", what,
                             limit, kMaxOfAnything);
    }
  }
  if (!fits(parts, 1, kMaxOfAnything)) {
    return invalidArgument("parts: found {}, expected 0 to {}", parts, kMaxOfAnything);
  }
  return {};
}

ProgramHost::ProgramHost(const DecomposeProgress& progress, int threadCount, int parts)
    : progress_(progress), parts_(parts) {
  threads = threadCount;
  reader = characterReader();
}

void ProgramHost::beginTask(const std::string& /*label*/, const std::string& unit) {
  counted_ = unit == "parts";
}

void ProgramHost::report(int done, int total, double /*share*/) {
  if (!progress_ || cancelled_) return;
  cancelled_ = counted_ ? !progress_(done, total) : !progress_(0, parts_);
}

}  // namespace lorica
