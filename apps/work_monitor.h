#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <string_view>

namespace lorica {

/// How far the work of another thread is, and whether it should stop. ProgressBar reports to the monitor of its thread,
/// if there is one, instead of to standard error.
class WorkMonitor {
 public:
  struct Progress {
    std::string label;  ///< the task: "Decomposing mannequin"; empty = not known yet
    int done = 0;
    int total = 0;  ///< 0 or less if unknown

    /// For a window: `label`, or "Loading".
    [[nodiscard]] std::string_view title() const { return label.empty() ? std::string_view("Loading") : label; }
    /// That is done; below 0 = unknown.
    [[nodiscard]] double share() const { return total > 0 ? static_cast<double>(done) / total : -1.0; }
  };

  /// Makes a monitor that of this thread during its lifetime.
  class Scope {
   public:
    explicit Scope(WorkMonitor& monitor);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
  };
  /// The monitor of this thread; null = none.
  [[nodiscard]] static WorkMonitor* ofThisThread();

  void report(Progress progress);
  [[nodiscard]] Progress progress() const;
  void cancel() { cancelled_ = true; }
  [[nodiscard]] bool cancelled() const { return cancelled_; }

 private:
  std::atomic<bool> cancelled_ = false;
  mutable std::mutex mutex_;
  Progress progress_;
};

}  // namespace lorica
