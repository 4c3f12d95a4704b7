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
    std::string label;   ///< the task: "Decomposing mannequin"; empty = not known yet
    double share = 0.0;  ///< of the whole work that is done, 0 to 1; never decreases

    /// For a window: `label`, or "Loading".
    [[nodiscard]] std::string_view title() const { return label.empty() ? std::string_view("Loading") : label; }
  };

  /// Makes a monitor that of this thread during its lifetime.
  class Scope {
   public:
    explicit Scope(WorkMonitor& monitor);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
  };
  /// A stage of the work of this thread, if that has a monitor: what is reported during its lifetime counts from one
  /// share of the enclosing stage to another, which is done when it ends.
  class Stage {
   public:
    Stage(double from, double to);
    ~Stage();
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;

   private:
    WorkMonitor* monitor_;
    double outerFrom_ = 0.0, outerTo_ = 1.0;
  };
  /// The monitor of this thread; null = none.
  [[nodiscard]] static WorkMonitor* ofThisThread();

  /// Begins a task. How many a stage has is not known before, so each takes most of what remains of it.
  void begin(std::string label);
  /// @param total  of the task; 0 or less if unknown
  void report(int done, int total);
  [[nodiscard]] Progress progress() const;
  void cancel() { cancelled_ = true; }
  [[nodiscard]] bool cancelled() const { return cancelled_; }

 private:
  void reach(double share);

  std::atomic<bool> cancelled_ = false;
  mutable std::mutex mutex_;
  Progress progress_;
  // Of the working thread only: shares at the ends of the present stage and task.
  double from_ = 0.0, to_ = 1.0;
  double taskFrom_ = 0.0, taskTo_ = 1.0;
};

}  // namespace lorica
