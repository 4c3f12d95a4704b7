#include "viewer/player/monitored_host.h"

#include "geometry/text.h"

#include <algorithm>
#include <tuple>

namespace lorica {
namespace {

constexpr double kOfTheRest = 0.85;         // of a stage, by each task
constexpr std::size_t kLongestLabel = 100;  // [bytes]

}  // namespace

MonitoredHost::MonitoredHost(Host& parent) : parent_(parent) {
  threads = parent.threads;
  paths = parent.paths;
  reader = parent.reader;
}

void MonitoredHost::beginStage(double from, double to) {
  outer_.emplace_back(from_, to_);
  const double width = to_ - from_;
  to_ = from_ + to * width;
  from_ += from * width;
  reach(from_);
}

void MonitoredHost::endStage() {
  reach(to_);
  std::tie(from_, to_) = outer_.back();
  outer_.pop_back();
}

void MonitoredHost::beginTask(const std::string& label, const std::string& /*unit*/) {
  const std::lock_guard lock(mutex_);
  taskFrom_ = std::clamp(progress_.share, from_, to_);
  taskTo_ = taskFrom_ + kOfTheRest * (to_ - taskFrom_);
  progress_.label = printable(label, kLongestLabel);
}

void MonitoredHost::report(int done, int total) {
  if (total > 0) reach(taskFrom_ + (taskTo_ - taskFrom_) * std::clamp(double(done) / total, 0.0, 1.0));
}

void MonitoredHost::reach(double share) {
  const std::lock_guard lock(mutex_);
  progress_.share = std::max(progress_.share, share);
}

MonitoredHost::Progress MonitoredHost::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

}  // namespace lorica
