#pragma once

#include "apps/work_monitor.h"
#include "geometry/result.h"

#include <chrono>
#include <functional>
#include <future>
#include <optional>
#include <utility>

namespace lorica {

/// Work in another thread that reports how far it is (ProgressBar) and can be cancelled.
template <class T>
class BackgroundWork {
 public:
  /// Starts it. @param work  should end soon after WorkMonitor::cancelled(); what it returns then does not count
  explicit BackgroundWork(std::function<Result<T>()> work)
      : result_(std::async(std::launch::async, [this, work = std::move(work)]() -> Result<T> {
          const WorkMonitor::Scope watched(monitor_);
          Result<T> done = work();
          if (monitor_.cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
          return done;
        })) {}
  /// Cancels and waits.
  ~BackgroundWork() { cancel(); }
  BackgroundWork(const BackgroundWork&) = delete;
  BackgroundWork& operator=(const BackgroundWork&) = delete;

  [[nodiscard]] WorkMonitor::Progress progress() const { return monitor_.progress(); }
  /// It ends soon, with kCancelled.
  void cancel() { monitor_.cancel(); }
  /// The result, once; none while it runs.
  [[nodiscard]] std::optional<Result<T>> take() {
    if (!result_.valid() || result_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
    return result_.get();
  }

 private:
  WorkMonitor monitor_;
  std::future<Result<T>> result_;
};

}  // namespace lorica
