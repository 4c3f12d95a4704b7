#include "viewer/player/monitored_host.h"

#include "geometry/text.h"

#include <algorithm>

namespace lorica {
namespace {

constexpr double kOfTheRest = 0.85;         // of a stage, by each task
constexpr std::size_t kLongestLabel = 100;  // [bytes]

}  // namespace

void WorkShare::beginStage(double from, double to) {
  outer_.push_back(stage_);
  const double width = stage_.to - stage_.from;
  stage_ = {stage_.from + from * width, stage_.from + to * width, worked_};
  share_ = std::max(share_, stage_.from);
}

/// What no task has reported was work all the same, if most of the stage was.
void WorkShare::endStage() {
  const bool mostly = worked_ - stage_.worked > 0.5 * (stage_.to - stage_.from);
  if (mostly) worked_ += std::max(stage_.to - share_, 0.0);
  share_ = std::max(share_, stage_.to);
  stage_ = outer_.back();
  outer_.pop_back();
}

void WorkShare::beginTask(bool whole) {
  taskFrom_ = std::clamp(share_, stage_.from, stage_.to);
  taskTo_ = taskFrom_ + (whole ? 1.0 : kOfTheRest) * (stage_.to - taskFrom_);
}

void WorkShare::report(int done, int total, double share) {
  if (total <= 0 && share < 0.0) return;
  const double ofTask = std::clamp(share < 0.0 ? double(done) / total : share, 0.0, 1.0);
  const double reached = taskFrom_ + (taskTo_ - taskFrom_) * ofTask;
  worked_ += std::max(reached - share_, 0.0);
  share_ = std::max(share_, reached);
}

MonitoredHost::MonitoredHost(Host& parent) : parent_(parent) {
  threads = parent.threads;
  paths = parent.paths;
  reader = parent.reader;
}

void MonitoredHost::beginStage(double from, double to, const std::string& /*name*/) {
  work_.beginStage(from, to);
  publish();
}

void MonitoredHost::endStage() {
  work_.endStage();
  publish();
}

void MonitoredHost::beginTask(const std::string& label, const std::string& /*unit*/) {
  work_.beginTask();
  const std::lock_guard lock(mutex_);
  progress_.label = printable(label, kLongestLabel);
}

void MonitoredHost::report(int done, int total, double share) {
  work_.report(done, total, share);
  publish();
}

void MonitoredHost::publish() {
  const std::lock_guard lock(mutex_);
  progress_.share = work_.share();
}

MonitoredHost::Progress MonitoredHost::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

}  // namespace lorica
