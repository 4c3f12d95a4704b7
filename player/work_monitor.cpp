#include "player/work_monitor.h"

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

constexpr double kOfTheRest = 0.85;  // of a stage, by each task

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

WorkMonitor::Stage::Stage(double from, double to) : monitor_(gMonitor) {
  if (monitor_ == nullptr) return;
  outerFrom_ = monitor_->from_;
  outerTo_ = monitor_->to_;
  monitor_->from_ = outerFrom_ + from * (outerTo_ - outerFrom_);
  monitor_->to_ = outerFrom_ + to * (outerTo_ - outerFrom_);
  monitor_->reach(monitor_->from_);
}

WorkMonitor::Stage::~Stage() {
  if (monitor_ == nullptr) return;
  monitor_->reach(monitor_->to_);
  monitor_->from_ = outerFrom_;
  monitor_->to_ = outerTo_;
}

void WorkMonitor::begin(std::string label) {
  const std::lock_guard lock(mutex_);
  taskFrom_ = std::clamp(progress_.share, from_, to_);
  taskTo_ = taskFrom_ + kOfTheRest * (to_ - taskFrom_);
  progress_.label = std::move(label);
}

void WorkMonitor::report(int done, int total) {
  if (total > 0) reach(taskFrom_ + (taskTo_ - taskFrom_) * std::clamp(static_cast<double>(done) / total, 0.0, 1.0));
}

void WorkMonitor::reach(double share) {
  const std::lock_guard lock(mutex_);
  progress_.share = std::max(progress_.share, share);
}

WorkMonitor::Progress WorkMonitor::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

}  // namespace lorica
