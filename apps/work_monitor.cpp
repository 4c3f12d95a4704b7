#include "apps/work_monitor.h"

#include <utility>

namespace lorica {
namespace {

thread_local WorkMonitor* gMonitor = nullptr;

}  // namespace

WorkMonitor::Scope::Scope(WorkMonitor& monitor) {
  gMonitor = &monitor;
}

WorkMonitor::Scope::~Scope() {
  gMonitor = nullptr;
}

WorkMonitor* WorkMonitor::ofThisThread() {
  return gMonitor;
}

void WorkMonitor::report(Progress progress) {
  const std::lock_guard lock(mutex_);
  progress_ = std::move(progress);
}

WorkMonitor::Progress WorkMonitor::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

}  // namespace lorica
